// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/path.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lsv {
namespace {

Shift shift_of(double dx_px, double dy_px, double sigma_x_px, double sigma_y_px,
               double model_sigma_x_px = 0.0) {
  Shift out;
  out.dx_px = dx_px;
  out.dy_px = dy_px;
  out.cov = {sigma_x_px * sigma_x_px, 0.0, sigma_y_px * sigma_y_px};
  out.model_sigma_x_px = model_sigma_x_px;
  out.model_sigma_y_px = 0.0;
  return out;
}

TEST(Path, StartsAtTheOriginWithoutDoubt) {
  const Path path;
  EXPECT_EQ(path.x_px(), 0.0);
  EXPECT_EQ(path.cov().yy_px2, 0.0);
}

TEST(Path, ThereAndBackIsTheOriginAndTheDoubtGrows) {
  Path path;
  path.add(shift_of(3.0, -1.0, 3e-3, 1e-3));
  path.add(shift_of(-3.0, 1.0, 4e-3, 0.0));
  EXPECT_EQ(path.x_px(), 0.0);
  EXPECT_EQ(path.y_px(), 0.0);
  EXPECT_NEAR(std::sqrt(path.cov().xx_px2), 5e-3, 1e-15);
  EXPECT_NEAR(std::sqrt(path.cov().yy_px2), 1e-3, 1e-15);
}

// A model error repeats with the motion and adds up linearly; noise does not.
TEST(Path, ModelErrorsAddUpLinearly) {
  Path path;
  for (int i = 0; i < 100; ++i) path.add(shift_of(1.0, 0.0, 5e-3, 5e-3, 3e-3));
  EXPECT_NEAR(std::sqrt(path.cov().xx_px2), std::hypot(100 * 3e-3, 10 * 4e-3), 1e-12);
  EXPECT_NEAR(std::sqrt(path.cov().yy_px2), 50e-3, 1e-12);
}

// 24 h at 1 kHz: a float32 sum of tenths of a px stops at 2^21 px.
TEST(Path, StillAdvancesAfterADayOfDriving) {
  Path path;
  const Shift step = shift_of(0.1, 0.0, 1e-3, 1e-3);
  constexpr int kFrames = 86'400'000;
  float single = 0.0F;
  for (int i = 0; i < kFrames; ++i) {
    path.add(step);
    single += 0.1F;
  }
  EXPECT_NEAR(path.x_px(), 8'640'000.0, 0.05);
  EXPECT_LT(single, 2'200'000.0F);
}

}  // namespace
}  // namespace lsv
