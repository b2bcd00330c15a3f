// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/hole_filler.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace lsv {
namespace {

/// counts = 3 x + 5 y + 10
template <typename Pixel>
Frame ramp(const FrameFormat& format) {
  Frame out(format);
  for (int y = 0; y < format.height_px; ++y) {
    for (int x = 0; x < format.width_px; ++x)
      reinterpret_cast<Pixel*>(out.row(y))[x] = static_cast<Pixel>(3 * x + 5 * y + 10);
  }
  return out;
}

std::vector<std::uint8_t> block(const FrameFormat& format, const Roi& at) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(format.width_px) *
                                static_cast<std::size_t>(format.height_px));
  for (int y = at.y_px; y < at.y_px + at.height_px; ++y) {
    for (int x = at.x_px; x < at.x_px + at.width_px; ++x)
      out[static_cast<std::size_t>(y * format.width_px + x)] = 1;
  }
  return out;
}

template <typename Pixel>
void restores_a_ramp(const FrameFormat& format) {
  const Roi hole{.x_px = 5, .y_px = 3, .width_px = 4, .height_px = 3};
  Frame frame = ramp<Pixel>(format);
  const Frame whole = ramp<Pixel>(format);
  for (int y = hole.y_px; y < hole.y_px + hole.height_px; ++y) {
    for (int x = hole.x_px; x < hole.x_px + hole.width_px; ++x)
      reinterpret_cast<Pixel*>(frame.row(y))[x] = 255;
  }
  HoleFiller filler(format);
  EXPECT_TRUE(filler.empty());
  filler.set(block(format, hole));
  EXPECT_FALSE(filler.empty());
  filler.fill(frame);
  for (int y = 0; y < format.height_px; ++y) {
    for (int x = 0; x < format.width_px; ++x)
      EXPECT_EQ(frame.view().at(x, y), whole.view().at(x, y)) << x << ' ' << y;
  }
}

TEST(HoleFiller, RestoresARamp) {
  restores_a_ramp<std::uint8_t>({.width_px = 20, .height_px = 12});
  restores_a_ramp<std::uint16_t>(
      {.width_px = 20, .height_px = 12, .type = PixelType::mono16, .bit_depth = 12});
}

// Above and left there is nothing: the nearest below and right are one and two steps off.
TEST(HoleFiller, TheNearerTheHeavier) {
  const FrameFormat format{.width_px = 6, .height_px = 4};
  Frame frame = ramp<std::uint8_t>(format);
  HoleFiller filler(format);
  filler.set(block(format, {.x_px = 0, .y_px = 0, .width_px = 2, .height_px = 1}));
  frame.row8(0)[2] = 40;  // two steps right of (0, 0)
  frame.row8(1)[0] = 100;
  filler.fill(frame);
  EXPECT_EQ(frame.view().at(0, 0), (40 * 0.5 + 100 * 1.0) / 1.5);
}

TEST(HoleFiller, HolesAreForgottenAndAFrameOfHolesStays) {
  const FrameFormat format{.width_px = 6, .height_px = 4};
  Frame frame = ramp<std::uint8_t>(format);
  HoleFiller filler(format);
  filler.set(block(format, {.x_px = 0, .y_px = 0, .width_px = 6, .height_px = 4}));
  filler.fill(frame);
  EXPECT_EQ(frame.view().at(3, 2), 29);
  filler.set(std::vector<std::uint8_t>(24));
  EXPECT_TRUE(filler.empty());
}

}  // namespace
}  // namespace lsv
