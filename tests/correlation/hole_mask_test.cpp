// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/hole_mask.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace lsv {
namespace {

constexpr FrameFormat kFormat{.width_px = 40, .height_px = 30};

std::vector<std::uint8_t> holes(const Roi& at) {
  std::vector<std::uint8_t> out(40 * 30);
  for (int y = at.y_px; y < at.y_px + at.height_px; ++y) {
    for (int x = at.x_px; x < at.x_px + at.width_px; ++x)
      out[static_cast<std::size_t>(y * 40 + x)] = 1;
  }
  return out;
}

/// 1 where the value was left out.
std::vector<std::uint8_t> left_out(const HoleMask& mask, const kernels::Region& region, int dx_px,
                                   int dy_px) {
  const std::vector<float> values(40 * 30, 7.0F);
  std::vector<float> out(40 * 30, 7.0F);
  mask.apply({values.data(), 40}, region, dx_px, dy_px, {out.data(), 40});
  std::vector<std::uint8_t> is_out;
  for (const float value : out) is_out.push_back(value == 7.0F ? 0 : 1);
  return is_out;
}

TEST(HoleMask, NarrowHolesDoNotCount) {
  HoleMask mask(kFormat);
  EXPECT_TRUE(mask.empty());
  mask.set(holes({.x_px = 10, .y_px = 10, .width_px = 20, .height_px = 2}));
  EXPECT_TRUE(mask.empty());
  mask.set(holes({.x_px = 10, .y_px = 10, .width_px = 3, .height_px = 3}));
  EXPECT_FALSE(mask.empty());
  mask.set(holes({.x_px = 10, .y_px = 10, .width_px = 1, .height_px = 1}));
  EXPECT_TRUE(mask.empty());
}

// The inner pixel of a 3 x 3 hole, 5 px around it: in the reference, and where it is compared.
TEST(HoleMask, LeavesOutWhatTheWeightsReachInBothFrames) {
  HoleMask mask(kFormat);
  mask.set(holes({.x_px = 19, .y_px = 14, .width_px = 3, .height_px = 3}));
  const kernels::Region whole{8, 6, 24, 18};
  const auto is_out = left_out(mask, whole, 6, -4);
  for (int y = 6; y < 24; ++y) {
    for (int x = 8; x < 32; ++x) {
      const bool here = std::abs(x - 20) <= 5 && std::abs(y - 15) <= 5;
      const bool there = std::abs(x + 6 - 20) <= 5 && std::abs(y - 4 - 15) <= 5;
      EXPECT_EQ(is_out[static_cast<std::size_t>(y * 40 + x)] != 0, here || there) << x << ' ' << y;
    }
  }
}

// A border has nothing behind it.
TEST(HoleMask, ABorderOfTwoPixelsIsWide) {
  HoleMask mask(kFormat);
  mask.set(holes({.x_px = 0, .y_px = 0, .width_px = 2, .height_px = 30}));
  EXPECT_FALSE(mask.empty());
  const auto is_out = left_out(mask, {0, 0, 40, 30}, 0, 0);
  EXPECT_EQ(is_out[15 * 40 + 5], 1);
  EXPECT_EQ(is_out[15 * 40 + 6], 0);
}

}  // namespace
}  // namespace lsv
