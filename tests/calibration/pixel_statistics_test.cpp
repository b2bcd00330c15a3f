// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/pixel_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calibration/light_level.h"

namespace lsv {
namespace {

constexpr FrameFormat kWide{
    .width_px = 7, .height_px = 5, .type = PixelType::mono16, .bit_depth = 16};

Frame random_frame(const FrameFormat& format, std::mt19937_64& random, int low, int high) {
  Frame out(format);
  std::uniform_int_distribution<int> count(low, high);
  for (int y = 0; y < format.height_px; ++y) {
    for (int x = 0; x < format.width_px; ++x)
      out.row16(y)[x] = static_cast<std::uint16_t>(count(random));
  }
  return out;
}

// Levels near full scale with a spread of some counts: sums of squares would lose the variance.
TEST(PixelStatistics, OnePassAgreesWithTwo) {
  constexpr int kFrames = 1000;
  std::mt19937_64 random(3);
  PixelStatistics statistics = PixelStatistics::create(kWide).value();
  std::vector<Frame> frames;
  for (int k = 0; k < kFrames; ++k) {
    frames.push_back(random_frame(kWide, random, 65000, 65004));
    ASSERT_TRUE(statistics.add(frames.back().view()));
  }
  ASSERT_EQ(statistics.frames(), kFrames);
  for (std::size_t i = 0; i < statistics.pixels(); ++i) {
    const int x = static_cast<int>(i % 7);
    const int y = static_cast<int>(i / 7);
    double mean = 0.0;
    for (const Frame& frame : frames) mean += frame.view().at(x, y) / static_cast<double>(kFrames);
    double squares = 0.0;
    for (const Frame& frame : frames) squares += std::pow(frame.view().at(x, y) - mean, 2.0);
    EXPECT_NEAR(statistics.mean_counts(i), mean, 1e-9);
    EXPECT_NEAR(statistics.variance_counts2(i), squares / (kFrames - 1), 1e-9);
  }
}

TEST(PixelStatistics, RowsOfAViewAreRows) {
  Frame big({.width_px = 9, .height_px = 4});
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 9; ++x) big.row8(y)[x] = static_cast<std::uint8_t>(10 * y + x);
  }
  const FrameView part = crop(big.view(), {.x_px = 2, .y_px = 1, .width_px = 3, .height_px = 2});
  PixelStatistics statistics = PixelStatistics::create(part.format).value();
  ASSERT_TRUE(statistics.add(part));
  EXPECT_EQ(statistics.mean_counts(0), 12.0);
  EXPECT_EQ(statistics.mean_counts(5), 24.0);
  EXPECT_EQ(statistics.frame_mean_counts(), 18.0);
  EXPECT_TRUE(std::isnan(statistics.variance_counts2(0)));
}

TEST(PixelStatistics, AStuckPixelHasNoVarianceAtAll) {
  std::mt19937_64 random(4);
  PixelStatistics statistics = PixelStatistics::create(kWide).value();
  for (int k = 0; k < 77; ++k) {
    Frame frame = random_frame(kWide, random, 100, 200);
    frame.row16(2)[3] = 65535;
    frame.row16(0)[1] = 0;
    ASSERT_TRUE(statistics.add(frame.view()));
  }
  EXPECT_EQ(statistics.variance_counts2(2 * 7 + 3), 0.0);
  EXPECT_EQ(statistics.times_full(2 * 7 + 3), 77U);
  EXPECT_EQ(statistics.times_zero(1), 77U);
  EXPECT_EQ(statistics.times_full(0) + statistics.times_zero(0), 0U);
}

TEST(PixelStatistics, AnotherFormatIsRefusedAndIgnored) {
  PixelStatistics statistics = PixelStatistics::create(kWide).value();
  Frame other({.width_px = 7, .height_px = 5, .type = PixelType::mono16, .bit_depth = 12});
  EXPECT_FALSE(statistics.add(other.view()));
  EXPECT_EQ(statistics.frames(), 0);
  EXPECT_FALSE(PixelStatistics::create({.width_px = 0, .height_px = 5}));
}

// Light that falls by a third over the sensor and flickers by 3 %: no noise of the pixels.
TEST(LightLevel, FlickerIsTakenOutOfTheNoise) {
  constexpr FrameFormat kFormat{
      .width_px = 96, .height_px = 64, .type = PixelType::mono16, .bit_depth = 12};
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  PixelStatistics dark = PixelStatistics::create(kFormat).value();
  PixelStatistics lit = PixelStatistics::create(kFormat).value();
  Frame frame(kFormat);
  const auto expose = [&](double light, PixelStatistics& to) {
    for (int y = 0; y < kFormat.height_px; ++y) {
      for (int x = 0; x < kFormat.width_px; ++x) {
        const double level = 200.0 + light * (1.2 - 0.4 * x / kFormat.width_px);
        frame.row16(y)[x] = static_cast<std::uint16_t>(std::lround(level + 4.0 * normal(random)));
      }
    }
    ASSERT_TRUE(to.add(frame.view()));
  };
  for (int k = 0; k < 60; ++k) {
    expose(0.0, dark);
    expose(1000.0 * (1.0 + 0.03 * normal(random)), lit);
  }
  const LightLevel level = light_level(lit, std::vector<std::uint8_t>(lit.pixels()), &dark);
  std::printf("variance %.4f +- %.4f, flicker %.2f\n", level.point.variance_counts2.value,
              level.point.variance_counts2.sigma, level.flicker_counts);
  EXPECT_NEAR(level.point.variance_counts2.value, 16.0 + 1.0 / 12.0,
              3.0 * level.point.variance_counts2.sigma);
  EXPECT_LT(level.point.variance_counts2.sigma, 0.15);  // of pixels that do not flicker: 0.04
  EXPECT_NEAR(level.flicker_counts, 30.0, 9.0);
}

}  // namespace
}  // namespace lsv
