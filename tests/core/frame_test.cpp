// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/frame.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace lsv {
namespace {

TEST(Frame, RowsAreAlignedAndHoldTheirPixels) {
  Frame frame({.width_px = 37, .height_px = 5, .type = PixelType::mono16, .bit_depth = 12});
  for (int y = 0; y < 5; ++y) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(frame.row(y)) % 64, 0U);
    for (int x = 0; x < 37; ++x) frame.row16(y)[x] = static_cast<std::uint16_t>(100 * y + x);
  }
  EXPECT_EQ(frame.view().at(36, 4), 436);
  EXPECT_EQ(frame.view().at(0, 1), 100);
}

TEST(Frame, ResetToASmallerFormatKeepsTheMemory) {
  Frame frame({.width_px = 64, .height_px = 64});
  const std::byte* const before = frame.view().data;
  frame.reset({.width_px = 32, .height_px = 48});
  EXPECT_EQ(frame.view().data, before);
  EXPECT_EQ(frame.view().width_px(), 32);
}

TEST(Crop, ShowsTheRegionColumnsFirst) {
  Frame frame({.width_px = 20, .height_px = 10});
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) frame.row8(y)[x] = static_cast<std::uint8_t>(10 * y + x);
  }
  const FrameView view = crop(frame.view(), {.x_px = 3, .y_px = 7, .width_px = 5, .height_px = 2});
  EXPECT_EQ(view.width_px(), 5);
  EXPECT_EQ(view.height_px(), 2);
  EXPECT_EQ(view.at(0, 0), 73);
  EXPECT_EQ(view.at(4, 1), 87);
}

TEST(Contains, RefusesEveryWayOut) {
  const FrameFormat format{.width_px = 20, .height_px = 10};
  EXPECT_TRUE(contains(format, {0, 0, 20, 10}));
  EXPECT_FALSE(contains(format, {0, 0, 21, 10}));
  EXPECT_FALSE(contains(format, {0, 0, 20, 11}));
  EXPECT_FALSE(contains(format, {-1, 0, 5, 5}));
  EXPECT_FALSE(contains(format, {0, -1, 5, 5}));
  EXPECT_FALSE(contains(format, {19, 0, 2, 5}));
  EXPECT_FALSE(contains(format, {0, 0, 0, 5}));
  EXPECT_FALSE(contains(format, {2147483647, 0, 2147483647, 5}));
}

}  // namespace
}  // namespace lsv
