// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/scale.h"

#include <Eigen/Core>
#include <cmath>

namespace lsv {
namespace {

/// Rows xx, xy, yx, yy; columns sc_x_ratio, sc_y_ratio, angle_rad, skew_rad.
Eigen::Matrix4d jacobian(const Calibration& c, const PixelScale& scale) {
  Eigen::Matrix4d out;
  out << -scale.xx / c.sc_x_ratio, 0.0, -scale.yx, 0.0,     //
      0.0, -scale.xy / c.sc_y_ratio, -scale.yy, -scale.yy,  //
      -scale.yx / c.sc_x_ratio, 0.0, scale.xx, 0.0,         //
      0.0, -scale.yy / c.sc_y_ratio, scale.xy, scale.xy;
  return out;
}

double variance(double dx_px, double dy_px, const ShiftCovariance& cov, double to_x, double to_y,
                const ShiftCovariance& scale_cov) {
  return to_x * to_x * cov.xx_px2 + 2.0 * to_x * to_y * cov.xy_px2 + to_y * to_y * cov.yy_px2 +
         dx_px * dx_px * scale_cov.xx_px2 + 2.0 * dx_px * dy_px * scale_cov.xy_px2 +
         dy_px * dy_px * scale_cov.yy_px2;
}

}  // namespace

PixelScale pixel_scale(const Calibration& calibration) {
  const double kx_m = calibration.pixel_pitch_x_m / calibration.sc_x_ratio;
  const double ky_m = calibration.pixel_pitch_y_m / calibration.sc_y_ratio;
  PixelScale out{.xx = kx_m, .xy = 0.0, .yx = 0.0, .yy = ky_m};
  if (!calibration.scale) return out;
  const auto& [angle_rad, skew_rad, mirrored] = calibration.scale->orientation;
  const double signed_ky_m = mirrored ? -ky_m : ky_m;
  out.xx = kx_m * std::cos(angle_rad);
  out.yx = kx_m * std::sin(angle_rad);
  out.xy = -signed_ky_m * std::sin(angle_rad + skew_rad);
  out.yy = signed_ky_m * std::cos(angle_rad + skew_rad);

  Eigen::Matrix4d cov;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j)
      cov(i, j) = calibration.scale->cov[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  const Eigen::Matrix4d j = jacobian(calibration, out);
  const Eigen::Matrix4d entries = j * cov * j.transpose();
  out.cov_x = {entries(0, 0), entries(0, 1), entries(1, 1)};
  out.cov_y = {entries(2, 2), entries(2, 3), entries(3, 3)};
  return out;
}

Travel travel(double dx_px, double dy_px, const ShiftCovariance& cov, const PixelScale& scale) {
  return {.x_m = scale.xx * dx_px + scale.xy * dy_px,
          .y_m = scale.yx * dx_px + scale.yy * dy_px,
          .sigma_x_m = std::sqrt(variance(dx_px, dy_px, cov, scale.xx, scale.xy, scale.cov_x)),
          .sigma_y_m = std::sqrt(variance(dx_px, dy_px, cov, scale.yx, scale.yy, scale.cov_y))};
}

Travel travel(const Shift& shift, const PixelScale& scale) {
  return travel(shift.dx_px, shift.dy_px, shift.cov, scale);
}

SensorVelocity velocity(const Travel& travel, double dt_s) {
  return {.vx_m_s = travel.x_m / dt_s,
          .vy_m_s = travel.y_m / dt_s,
          .sigma_vx_m_s = travel.sigma_x_m / dt_s,
          .sigma_vy_m_s = travel.sigma_y_m / dt_s};
}

}  // namespace lsv
