// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/defect_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace lsv {
namespace {

constexpr int kSide_px = 64;
constexpr std::size_t kPixels = kSide_px * kSide_px;
constexpr FrameFormat kFormat{
    .width_px = kSide_px, .height_px = kSide_px, .type = PixelType::mono16, .bit_depth = 12};

/// Gaussian pixels, made without the simulator; `change` spoils some of them.
struct Sensor {
  std::vector<double> offset_counts = std::vector<double>(kPixels);
  std::vector<double> gain_ratio = std::vector<double>(kPixels);
  std::vector<double> noise_counts = std::vector<double>(kPixels, 3.0);
  std::vector<int> stuck_counts = std::vector<int>(kPixels, -1);

  explicit Sensor(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    for (double& value : offset_counts) value = 100.0 + 4.0 * normal(random);
    for (double& value : gain_ratio) value = 1.0 + 0.015 * normal(random);
  }

  /// The light falls by a fifth over the sensor.
  PixelStatistics expose(double light_counts, int frames, std::mt19937_64& random) const {
    std::normal_distribution<double> normal;
    PixelStatistics out = PixelStatistics::create(kFormat).value();
    Frame frame(kFormat);
    for (int k = 0; k < frames; ++k) {
      for (std::size_t i = 0; i < kPixels; ++i) {
        const double fall = 1.1 - 0.2 * static_cast<double>(i % kSide_px) / kSide_px;
        const double signal = light_counts * fall * gain_ratio[i];
        const double noise = std::hypot(noise_counts[i], std::sqrt(0.4 * signal)) * normal(random);
        const double count = std::clamp(offset_counts[i] + signal + noise, 0.0, 4095.0);
        frame.row16(static_cast<int>(i) / kSide_px)[i % kSide_px] =
            static_cast<std::uint16_t>(stuck_counts[i] >= 0 ? stuck_counts[i] : std::lround(count));
      }
      EXPECT_TRUE(out.add(frame.view()));
    }
    return out;
  }
};

DefectPixels found(const Sensor& sensor, int frames, std::mt19937_64& random) {
  const PixelStatistics dark = sensor.expose(0.0, frames, random);
  DefectPixels out = find_dark_defects(dark);
  add_lit_defects(dark, sensor.expose(2500.0, frames, random), out);
  return out;
}

// kFalseDefects are promised: 0.05 a sensor, and under 0.1 with the scatter of 120 sensors.
TEST(DefectPixels, ACleanSensorHasNone) {
  constexpr int kSensors = 120;
  std::size_t invented = 0;
  for (int k = 0; k < kSensors; ++k) {
    std::mt19937_64 random(1000 + static_cast<unsigned>(k));
    const Sensor sensor(random);
    const DefectPixels defects = found(sensor, 6, random);
    invented += defects.counts.hot + defects.counts.dead;
  }
  std::printf("%zu false defects on %d clean sensors of %zu pixels\n", invented, kSensors, kPixels);
  EXPECT_LT(static_cast<double>(invented), 0.1 * kSensors);
}

TEST(DefectPixels, EachKindIsFound) {
  std::mt19937_64 random(8);
  Sensor sensor(random);
  const std::size_t hot = 5 * kSide_px + 9, noisy = 20 * kSide_px + 30, weak = 40 * kSide_px + 2,
                    dead = 0, stuck = kPixels - 1, cold = 33 * kSide_px + 33;
  sensor.offset_counts[hot] += 40.0;
  sensor.noise_counts[noisy] = 12.0;
  sensor.gain_ratio[weak] = 0.85;
  sensor.gain_ratio[dead] = 0.0;
  sensor.stuck_counts[stuck] = 2000;
  sensor.stuck_counts[cold] = 0;
  const DefectPixels defects = found(sensor, 20, random);
  for (const std::size_t i : {hot, noisy, weak, dead, stuck, cold})
    EXPECT_EQ(defects.defect[i], 1) << i;
  EXPECT_EQ(defects.counts.hot, 3U);   // hot, noisy, and the one stuck at a high count
  EXPECT_EQ(defects.counts.dead, 3U);  // weak, dead, and the one stuck at 0
  EXPECT_EQ(defects.counts.stuck, 2U);
  EXPECT_EQ(std::ranges::count(defects.defect, 1), 6);
}

// A column that is dead, its neighbours being good.
TEST(DefectPixels, ADeadColumnDoesNotHideItself) {
  std::mt19937_64 random(9);
  Sensor sensor(random);
  for (std::size_t y = 0; y < kSide_px; ++y) sensor.gain_ratio[y * kSide_px + 17] = 0.05;
  const DefectPixels defects = found(sensor, 20, random);
  EXPECT_EQ(defects.counts.dead, static_cast<std::size_t>(kSide_px));
  EXPECT_EQ(defects.counts.hot, 0U);
}

// Rounding makes quiet pixels look unlike each other; none of them is noisy.
TEST(DefectPixels, QuietPixelsAreNotNoisy) {
  for (const double noise_counts : {0.02, 0.1, 0.2, 0.4}) {
    std::mt19937_64 random(10);
    Sensor sensor(random);
    std::ranges::fill(sensor.noise_counts, noise_counts);
    const PixelStatistics dark = sensor.expose(0.0, 20, random);
    EXPECT_EQ(find_dark_defects(dark).counts.hot, 0U) << noise_counts;
    std::ranges::fill(sensor.offset_counts, 100.3);
    const PixelStatistics alike = sensor.expose(0.0, 20, random);
    EXPECT_EQ(find_dark_defects(alike).counts.hot, 0U) << noise_counts;
  }
}

}  // namespace
}  // namespace lsv
