// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/scale.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(Displacement, UsesEachAxisItsOwnPitchAndScale) {
  const Displacement travel = displacement(shift_of(4.0, -2.0), pixel_scale(unlike_axes()));
  EXPECT_DOUBLE_EQ(travel.x_m, 20e-6);
  EXPECT_DOUBLE_EQ(travel.y_m, -40e-6);
  EXPECT_DOUBLE_EQ(travel.sigma_x_m, 0.2 * 5e-6);
  EXPECT_DOUBLE_EQ(travel.sigma_y_m, 0.3 * 20e-6);
}

TEST(Displacement, IsLinearAndOdd) {
  const PixelScale scale = pixel_scale(unlike_axes());
  for (const double px : {0.0, 1e-8, 0.37, 31.5}) {
    const Displacement there = displacement(shift_of(px, 2.0 * px), scale);
    const Displacement back = displacement(shift_of(-px, -2.0 * px), scale);
    EXPECT_DOUBLE_EQ(there.x_m, -back.x_m);
    EXPECT_DOUBLE_EQ(there.y_m, 8.0 * there.x_m);
  }
}

TEST(Velocity, DividesByTheTimeAndKeepsTheSign) {
  const Displacement travel = displacement(shift_of(-3.0, 1.0), pixel_scale(unlike_axes()));
  const SensorVelocity slow = velocity(travel, 0.002);
  const SensorVelocity fast = velocity(travel, 0.001);
  EXPECT_LT(slow.vx_m_s, 0.0);
  EXPECT_DOUBLE_EQ(fast.vx_m_s, 2.0 * slow.vx_m_s);
  EXPECT_DOUBLE_EQ(fast.sigma_vy_m_s, 2.0 * slow.sigma_vy_m_s);
  EXPECT_DOUBLE_EQ(slow.vy_m_s, 20e-6 / 0.002);
}

TEST(Velocity, OfAnUnknownShiftIsUnknown) {
  const SensorVelocity v = velocity(displacement(Shift{}, pixel_scale(unlike_axes())), 0.001);
  EXPECT_TRUE(std::isnan(v.vx_m_s));
  EXPECT_TRUE(std::isnan(v.sigma_vy_m_s));
}

}  // namespace
}  // namespace lsv
