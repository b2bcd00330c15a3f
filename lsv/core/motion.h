// SPDX-License-Identifier: BSD-3-Clause
// Metric motion of the sensor over the ground, in SENSOR axes: x along image columns and y along
// image rows, or the reference axes of the calibration where it has them. The mount (sensor to body
// axes, REP-103) is a later, separate type, so that it cannot be forgotten.
#pragma once

#include "lsv/core/shift.h"

namespace lsv {

struct SensorVelocity {
  double vx_m_s = kUnknown;
  double vy_m_s = kUnknown;
  double sigma_vx_m_s = kUnknown;
  double sigma_vy_m_s = kUnknown;
};

/// Distance travelled since the first frame along fixed sensor axes. The sigmas hold the error of
/// the accepted shifts and, where the calibration tells it, of the scale; nothing for gaps.
struct SensorPosition {
  double x_m = 0.0;
  double y_m = 0.0;
  double sigma_x_m = 0.0;
  double sigma_y_m = 0.0;
};

}  // namespace lsv
