// SPDX-License-Identifier: BSD-3-Clause
// What the sensors of a rover say, one sample each. Stamps of all sensors are on one clock; body
// axes are those of REP-103: x forward, y left, z up, yaw counter-clockwise. Plain values.
#pragma once

#include "lsv/core/shift.h"
#include "lsv/core/stamp.h"

namespace lsv {

/// Velocity of one LSV sensor over the ground, in the axes of the sensor.
struct LsvSample {
  Stamp stamp{};             // end of the interval that the velocity was measured over
  double interval_s = 0.0;   // length of it, >= 0; the velocity counts for its middle
  double vx_m_s = kUnknown;  // finite
  double vy_m_s = kUnknown;
  double sigma_vx_m_s = kUnknown;  // > 0; NaN: that of the configuration
  double sigma_vy_m_s = kUnknown;
};

/// Rates of the two wheels, positive where the rover rolls forward.
struct WheelSample {
  Stamp stamp{};
  double left_rad_s = kUnknown;  // finite
  double right_rad_s = kUnknown;
};

/// Rate gyro about body z.
struct GyroSample {
  Stamp stamp{};
  double wz_rad_s = kUnknown;  // finite
};

/// Somebody knows that the rover stands: the tracker that says `at_rest`, the parking brake.
struct StandstillSample {
  Stamp stamp{};
  double sigma_m_s = 1e-4;  // > 0
  double sigma_rad_s = 1e-4;
};

/// What became of a sample when it was handed over.
enum class SampleStatus {
  taken,           // used, or weighed and found wanting: FusionCounters says which
  invalid,         // not finite, or a sigma that is not above zero
  unknown_sensor,  // the configuration has no such sensor
  too_late,        // older than what the navigator can go back to
};

}  // namespace lsv
