// SPDX-License-Identifier: BSD-3-Clause
// From pattern shift in px to surface motion in metres, per sensor axis: Masuku thesis eqs 3.8-3.11
// and 6.4, read with the corrections that give them brackets and one coefficient per axis:
//   travel_m = shift_px * pitch_m / Sc
//   v_m_s    = shift_px * pitch_m / (Sc * dt_s)
//   sigma_v  = sigma_px * pitch_m / (Sc * dt_s)
// Pure functions of their arguments.
#pragma once

#include "lsv/core/config.h"
#include "lsv/core/motion.h"
#include "lsv/core/shift.h"

namespace lsv {

/// Surface travel per px of pattern shift.
struct PixelScale {
  double x_m_per_px = kUnknown;
  double y_m_per_px = kUnknown;
};

/// `calibration` must be valid (validate()).
PixelScale pixel_scale(const Calibration& calibration);

/// Signed surface displacement between the two frames of one shift.
struct Displacement {
  double x_m = kUnknown;
  double y_m = kUnknown;
  double sigma_x_m = kUnknown;
  double sigma_y_m = kUnknown;
  double model_sigma_x_m = 0.0;  // part of sigma_x_m that repeats with the motion, see Shift
  double model_sigma_y_m = 0.0;
};

/// NaN where the shift is NaN.
Displacement displacement(const Shift& shift, const PixelScale& scale);

/// `dt_s` > 0: time between the two frames.
SensorVelocity velocity(const Displacement& travel, double dt_s);

}  // namespace lsv
