// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/scale.h"

#include <cmath>

namespace lsv {

PixelScale pixel_scale(const Calibration& calibration) {
  return {.x_m_per_px = calibration.pixel_pitch_x_m / calibration.sc_x_ratio,
          .y_m_per_px = calibration.pixel_pitch_y_m / calibration.sc_y_ratio};
}

Displacement displacement(const Shift& shift, const PixelScale& scale) {
  return {.x_m = shift.dx_px * scale.x_m_per_px,
          .y_m = shift.dy_px * scale.y_m_per_px,
          .sigma_x_m = std::sqrt(shift.cov.xx_px2) * scale.x_m_per_px,
          .sigma_y_m = std::sqrt(shift.cov.yy_px2) * scale.y_m_per_px,
          .model_sigma_x_m = shift.model_sigma_x_px * scale.x_m_per_px,
          .model_sigma_y_m = shift.model_sigma_y_px * scale.y_m_per_px};
}

SensorVelocity velocity(const Displacement& travel, double dt_s) {
  return {.vx_m_s = travel.x_m / dt_s,
          .vy_m_s = travel.y_m / dt_s,
          .sigma_vx_m_s = travel.sigma_x_m / dt_s,
          .sigma_vy_m_s = travel.sigma_y_m / dt_s};
}

}  // namespace lsv
