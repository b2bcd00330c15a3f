// SPDX-License-Identifier: BSD-3-Clause
// From pattern shift in px to surface motion in metres: Masuku thesis eqs 3.8-3.11 and 6.4, read
// with the corrections that give them brackets and one coefficient per axis, and with the
// orientation of lsv/core/calibration.h. Along the image axes:
//   travel_m = shift_px * pitch_m / Sc
//   v_m_s    = shift_px * pitch_m / (Sc * dt_s)
//   sigma_v  = sigma_px * pitch_m / (Sc * dt_s)
// Where the calibration says how well it knows the scale, that is part of every sigma: an error of
// the scale is the same for every shift, so over a drive it grows with the distance.
// Pure functions of their arguments.
#pragma once

#include <array>

#include "lsv/core/calibration.h"
#include "lsv/core/motion.h"
#include "lsv/core/shift.h"

namespace lsv {

/// travel_m = (xx dx + xy dy, yx dx + yy dy), in m per px.
struct PixelScale {
  double xx = kUnknown;
  double xy = kUnknown;
  double yx = kUnknown;
  double yy = kUnknown;
  /// Covariance of (xx, xy) and of (yx, yy), (m/px)^2; zero where the calibration is silent.
  ShiftCovariance cov_x{0.0, 0.0, 0.0};
  ShiftCovariance cov_y{0.0, 0.0, 0.0};
};

/// `calibration` must be valid (validate()).
PixelScale pixel_scale(const Calibration& calibration);

/// Signed surface travel along the reference axes.
struct Travel {
  double x_m = kUnknown;
  double y_m = kUnknown;
  double sigma_x_m = kUnknown;
  double sigma_y_m = kUnknown;
};

/// Of a shift or of a sum of shifts. NaN where an argument is NaN.
Travel travel(double dx_px, double dy_px, const ShiftCovariance& cov, const PixelScale& scale);
Travel travel(const Shift& shift, const PixelScale& scale);

/// `dt_s` > 0: time between the two frames.
SensorVelocity velocity(const Travel& travel, double dt_s);

}  // namespace lsv
