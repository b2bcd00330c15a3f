// SPDX-License-Identifier: BSD-3-Clause
// The numbers printed in the Masuku thesis, through the public scaling functions. Where the
// thesis contradicts itself the reading is stated beside the case.
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/scale.h"
#include "tests/support/calibration.h"

namespace lsv {
namespace {

Shift shift_of(double dx_px, double dy_px, double sigma_px = 0.0) {
  Shift out;
  out.dx_px = dx_px;
  out.dy_px = dy_px;
  out.cov = {.xx_px2 = sigma_px * sigma_px, .xy_px2 = 0.0, .yy_px2 = sigma_px * sigma_px};
  out.status = ShiftStatus::ok;
  return out;
}

// Table 3.1; its columns are dy, dx, Q in that order. Eqs 3.8 and 3.9 give the displacement of one
// frame, although the thesis calls it position.
TEST(Thesis, Table31InMetres) {
  constexpr struct {
    double dy_px, dx_px;
  } kRows[] = {{0.0576, -0.0609}, {0.0709, -0.0929}, {0.042, -0.0575}, {0.052, -0.0583},
               {0.036, -0.0445},  {0.0464, -0.031},  {0.0324, -0.04},  {0.0466, -0.0186},
               {0.0206, -0.0058}, {0.0268, 0.02},    {0.0165, 0.0264}};
  const PixelScale scale = pixel_scale(test::bridget_calibration());
  double sum_x_m = 0.0, sum_y_m = 0.0;
  for (const auto& [dy_px, dx_px] : kRows) {
    const Travel way = travel(shift_of(dx_px, dy_px), scale);
    const double want_x_m = dx_px * (14.0 * 1e-6) / 1.985;
    const double want_y_m = dy_px * (14.0 * 1e-6) / 2.000;
    EXPECT_NEAR(way.x_m, want_x_m, 1e-12 * std::abs(want_x_m));
    EXPECT_NEAR(way.y_m, want_y_m, 1e-12 * std::abs(want_y_m));
    sum_x_m += way.x_m;
    sum_y_m += way.y_m;
  }
  // By hand: the columns add up to -0.3631 px and 0.4478 px.
  EXPECT_NEAR(sum_x_m, -0.3631 * 14e-6 / 1.985, 1e-15);
  EXPECT_NEAR(sum_y_m, 0.4478 * 7e-6, 1e-15);
}

// Appendix E: columns time, vx, vy, shift x, shift y and two running deviations. The rows fit a
// frame rate of 6000 Hz with Sc 1.985 and 2.000, and no other rate named in the thesis.
TEST(Thesis, AppendixEVelocities) {
  constexpr struct {
    double vx_m_s, vy_m_s, dx_px, dy_px;
  } kRows[] = {{0.127, 4.20e-2, 3, 1},     {-0.254, 4.20e-2, -6, 1},   {0.296, -8.40e-2, 7, -2},
               {-0.212, -4.20e-2, -5, -1}, {-0.212, -4.20e-2, -5, -1}, {0.254, 4.20e-2, 6, 1},
               {-0.381, 4.20e-2, -9, 1},   {0.254, 0.0, 6, 0},         {-0.127, 0.0, -3, 0},
               {-0.296, -4.20e-2, -7, -1}, {0.381, 0.0, 9, 0},         {-0.339, 4.20e-2, -8, 1},
               {0.296, -4.20e-2, 7, -1},   {-0.042, 0.0, -1, 0},       {-0.042, -4.20e-2, -1, -1},
               {0.339, 4.20e-2, 8, 1},     {-0.339, 4.20e-2, -8, 1}};
  const PixelScale scale = pixel_scale(test::bridget_calibration());
  for (const auto& row : kRows) {
    const SensorVelocity v = velocity(travel(shift_of(row.dx_px, row.dy_px), scale), 1.0 / 6000.0);
    EXPECT_NEAR(v.vx_m_s, row.vx_m_s, 0.0005);  // half of the last printed digit
    EXPECT_NEAR(v.vy_m_s, row.vy_m_s, 1e-9);
    const SensorVelocity as_3_11 =
        velocity(travel(shift_of(row.dx_px, row.dy_px), scale), 1.0 / 600.0);
    EXPECT_NEAR(as_3_11.vx_m_s * 10.0, row.vx_m_s, 0.0005);  // the 600 Hz of 3.11: ten times less
  }
}

// Section 6.4, with the brackets eq. 6.4 lacks: 0.1 px is 0.7 mm/s only at 1 kHz and Sc = 2.
TEST(Thesis, VelocityNoiseOfSection64) {
  Calibration calibration = test::bridget_calibration();
  calibration.sc_x_ratio = 2.0;
  const Travel way = travel(shift_of(0.0, 0.0, 0.1), pixel_scale(calibration));
  EXPECT_NEAR(velocity(way, 1e-3).sigma_vx_m_s, 0.700e-3, 1e-12);
  EXPECT_NEAR(velocity(way, 1.0 / 600.0).sigma_vx_m_s, 0.42e-3, 1e-12);
  EXPECT_NEAR(velocity(way, 1.0 / 6000.0).sigma_vx_m_s, 4.2e-3, 1e-12);
}

// Section 3.5.2: 80 mm/s stays inside the +-32 px search range.
TEST(Thesis, SpeedRangeOfTheSearchWindow) {
  const PixelScale scale = pixel_scale(test::bridget_calibration());
  EXPECT_NEAR(0.080 * 1e-3 / scale.yy, 11.43, 0.005);
  EXPECT_NEAR(0.080 / 600.0 / scale.yy, 19.05, 0.005);
}

// The ratio of the two coefficients: a 0.76 % difference between the axes.
TEST(Thesis, TheAxesHaveTheirOwnCoefficient) {
  const PixelScale scale = pixel_scale(test::bridget_calibration());
  EXPECT_NEAR(scale.xx / scale.yy, 1.0076, 5e-5);
}

}  // namespace
}  // namespace lsv
