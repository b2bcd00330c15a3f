// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lsv {
namespace {

Calibration unlike_axes() {
  Calibration out;
  out.pixel_pitch_x_m = 10e-6;
  out.pixel_pitch_y_m = 30e-6;
  out.sc_x_ratio = 2.0;
  out.sc_y_ratio = 1.5;
  return out;
}

Shift shift_of(double dx_px, double dy_px) {
  Shift out;
  out.dx_px = dx_px;
  out.dy_px = dy_px;
  out.cov = {.xx_px2 = 0.04, .xy_px2 = 0.0, .yy_px2 = 0.09};
  out.status = ShiftStatus::ok;
  return out;
}

TEST(Travel, UsesEachAxisItsOwnPitchAndScale) {
  const Travel way = travel(shift_of(4.0, -2.0), pixel_scale(unlike_axes()));
  EXPECT_DOUBLE_EQ(way.x_m, 20e-6);
  EXPECT_DOUBLE_EQ(way.y_m, -40e-6);
  EXPECT_DOUBLE_EQ(way.sigma_x_m, 0.2 * 5e-6);
  EXPECT_DOUBLE_EQ(way.sigma_y_m, 0.3 * 20e-6);
}

TEST(Travel, IsLinearAndOdd) {
  const PixelScale scale = pixel_scale(unlike_axes());
  for (const double px : {0.0, 1e-8, 0.37, 31.5}) {
    const Travel there = travel(shift_of(px, 2.0 * px), scale);
    const Travel back = travel(shift_of(-px, -2.0 * px), scale);
    EXPECT_DOUBLE_EQ(there.x_m, -back.x_m);
    EXPECT_DOUBLE_EQ(there.y_m, 8.0 * there.x_m);
  }
}

Calibration oriented(double angle_rad, double skew_rad, bool mirrored) {
  Calibration out = unlike_axes();
  out.scale.emplace();
  out.scale->orientation = {.angle_rad = angle_rad, .skew_rad = skew_rad, .mirrored = mirrored};
  return out;
}

// The reference x axis is where image y points, and image x points against the reference y axis.
TEST(Travel, FollowsTheOrientation) {
  const double quarter_rad = std::numbers::pi / 2.0;
  const Travel turned = travel(shift_of(4.0, -2.0), pixel_scale(oriented(quarter_rad, 0.0, false)));
  EXPECT_NEAR(turned.x_m, 40e-6, 1e-18);
  EXPECT_NEAR(turned.y_m, 20e-6, 1e-18);
  EXPECT_NEAR(turned.sigma_x_m, 0.3 * 20e-6, 1e-18);
  const Travel mirrored = travel(shift_of(4.0, -2.0), pixel_scale(oriented(0.0, 0.0, true)));
  EXPECT_NEAR(mirrored.x_m, 20e-6, 1e-18);
  EXPECT_NEAR(mirrored.y_m, 40e-6, 1e-18);
  const Travel skewed = travel(shift_of(0.0, 1.0), pixel_scale(oriented(0.0, 0.01, false)));
  EXPECT_NEAR(skewed.x_m, -20e-6 * std::sin(0.01), 1e-18);
}

// First-order propagation against a spread of scales drawn one figure at a time.
TEST(Travel, HoldsTheUncertaintyOfTheScale) {
  Calibration c = oriented(0.7, 0.02, true);
  const double steps[] = {2e-4, 1e-4, 3e-4, 5e-5};  // sc_x, sc_y, angle, skew
  for (std::size_t i = 0; i < 4; ++i) c.scale->cov[i][i] = steps[i] * steps[i];
  Shift shift = shift_of(1000.0, -300.0);
  shift.cov = {0.0, 0.0, 0.0};
  const Travel way = travel(shift, pixel_scale(c));
  double variance_x = 0.0;
  double variance_y = 0.0;
  for (int i = 0; i < 4; ++i) {
    Travel moved[2];
    for (const int sign : {-1, 1}) {
      Calibration changed = c;
      double* const figures[] = {&changed.sc_x_ratio, &changed.sc_y_ratio,
                                 &changed.scale->orientation.angle_rad,
                                 &changed.scale->orientation.skew_rad};
      *figures[i] += sign * steps[i];
      moved[sign > 0] = travel(shift, pixel_scale(changed));
    }
    variance_x += std::pow(0.5 * (moved[1].x_m - moved[0].x_m), 2);
    variance_y += std::pow(0.5 * (moved[1].y_m - moved[0].y_m), 2);
  }
  EXPECT_NEAR(way.sigma_x_m, std::sqrt(variance_x), 1e-6 * way.sigma_x_m);
  EXPECT_NEAR(way.sigma_y_m, std::sqrt(variance_y), 1e-6 * way.sigma_y_m);
  // It grows with the distance, not with its root.
  shift.dx_px *= 2.0;
  shift.dy_px *= 2.0;
  EXPECT_NEAR(travel(shift, pixel_scale(c)).sigma_x_m, 2.0 * way.sigma_x_m, 1e-12);
}

TEST(Velocity, DividesByTheTimeAndKeepsTheSign) {
  const Travel way = travel(shift_of(-3.0, 1.0), pixel_scale(unlike_axes()));
  const SensorVelocity slow = velocity(way, 0.002);
  const SensorVelocity fast = velocity(way, 0.001);
  EXPECT_LT(slow.vx_m_s, 0.0);
  EXPECT_DOUBLE_EQ(fast.vx_m_s, 2.0 * slow.vx_m_s);
  EXPECT_DOUBLE_EQ(fast.sigma_vy_m_s, 2.0 * slow.sigma_vy_m_s);
  EXPECT_DOUBLE_EQ(slow.vy_m_s, 20e-6 / 0.002);
}

TEST(Velocity, OfAnUnknownShiftIsUnknown) {
  const SensorVelocity v = velocity(travel(Shift{}, pixel_scale(unlike_axes())), 0.001);
  EXPECT_TRUE(std::isnan(v.vx_m_s));
  EXPECT_TRUE(std::isnan(v.sigma_vy_m_s));
}

}  // namespace
}  // namespace lsv
