// SPDX-License-Identifier: BSD-3-Clause
// One drive as a reference system and as a sensor on the body saw it: what a mount is found from
// (mount_fit.h, scale_ratio.h). Frames and signs: docs/mount.md.
#pragma once

#include <vector>

#include "lsv/core/shift.h"
#include "lsv/core/stamp.h"

namespace lsv {

/// Pose of the body frame (x forward, y left, z up) in a frame that is fixed to the ground, z up.
struct ReferencePose {
  Stamp stamp{};
  double x_m = kUnknown;
  double y_m = kUnknown;
  double yaw_rad = kUnknown;  // from ground x to body x, counter-clockwise; full turns do not count
  double sigma_m = kUnknown;  // per axis, > 0; errors of different poses are independent
  double sigma_yaw_rad = kUnknown;  // > 0
};

/// Stamps increase.
using BodyReference = std::vector<ReferencePose>;

/// One accepted shift as travel of the sensor over the ground, along the reference axes of its
/// calibration. Shorter than a quarter of kFarthestStamp_ns.
struct TrackStep {
  Stamp begin{};
  Stamp end{};  // > begin
  double dx_m = kUnknown;
  double dy_m = kUnknown;
  /// Covariance of the shift alone, without that of the scale; errors of different steps are
  /// independent.
  double xx_m2 = 0.0;
  double xy_m2 = 0.0;
  double yy_m2 = 0.0;
  /// Frames between its two were refused: where the sensor was in that time is not known.
  bool spans_refused = false;
};

/// Each begins where the one before ends, or later: then the travel in between is not known.
using SensorTrack = std::vector<TrackStep>;

/// Where a sensor sits, measured by other means: in the body frame.
struct KnownLever {
  double x_m = kUnknown;
  double y_m = kUnknown;
  double sigma_m = kUnknown;  // per axis, > 0
};

}  // namespace lsv
