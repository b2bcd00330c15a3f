// SPDX-License-Identifier: BSD-3-Clause
// How the scales of two sensors on one body compare, whatever the true scale is. Turned by the
// heading, the two travels obey
//   D2 = ratio R(yaw1 - yaw2) D1 + (R(h') - R(h)) c,   c = R(-yaw2) (r2 - r1) / k2
// from one heading h to the next h': straight or not, and with nothing of the reference but its
// heading. A ratio that is off is read as turning: two sensors side by side, the second at the
// distance B to the left, turn by -(ratio - 1) / B rad per metre driven straight ahead.
//
// Unknown are the ratio, the angle between the sensors, c, the offset of their clocks (to 20 ms
// where the drive does not tell), and at every reference pose the true heading and the places of
// the sensors to each other: total least squares as in mount_fit.h. The two are held together by a
// rig that gives way a little (clocks that jitter, a frame that bends); how much, is found from the
// drive. Left out, up to a tenth of all, are poses whose heading is more than 6 sigma off, and
// travel between two poses that stands out ten times from the rest: a shift that was accepted and
// wrong. The covariance is raised where the residuals are larger than the sigmas allow. Pure
// functions; they allocate.
#pragma once

#include <cstddef>
#include <optional>

#include "calibration/drive.h"
#include "lsv/core/calibration.h"
#include "lsv/core/result.h"

namespace lsv {

/// One of the two sensors, as far as it is known.
struct PairSensor {
  SensorTrack track;
  double clock_offset_s = 0.0;  // to be added to the times of the track
  Mount mount{};                // with sigmas
};

struct ScaleRatio {
  double ratio = kUnknown;  // travel that the second reads / travel that the first reads
  double sigma_ratio = kUnknown;
  double yaw_rad = kUnknown;  // of the second against the first
  double sigma_yaw_rad = kUnknown;
  double clock_offset_s = kUnknown;  // to be added to the times of the second, besides its own
  double sigma_clock_offset_s = kUnknown;
  double chi2 = kUnknown;
  int dof = 0;
  double sigma_factor = 1.0;
  double travel_m = 0.0;
  double rig_sigma_m = kUnknown;  // by which the sensors move against each other, per axis
  std::size_t outliers = 0;       // poses and links left out
};

enum class Baseline {
  from_motion,  // found with the ratio: the body turns
  from_mounts,  // the mounts count as measured: the body need not turn
};

/// bad_input when the tracks have too little in common, when they do not move, or when more than a
/// tenth would be left out.
Result<ScaleRatio> fit_scale_ratio(const BodyReference& reference, const PairSensor& first,
                                   const PairSensor& second, Baseline baseline);

/// The yaw that two sensors see while the body drives straight ahead, when their scales are taken
/// as equal: rad per metre, positive to the left. 0 for sensors one behind the other. NaN for two
/// at one place.
double false_yaw_rad_per_m(double ratio, const Mount& first, const Mount& second);

/// The calibration with which its sensor reads 1 / `ratio` of what it did.
Calibration with_reading_divided(const Calibration& calibration, double ratio);

}  // namespace lsv
