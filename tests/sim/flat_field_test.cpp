// SPDX-License-Identifier: BSD-3-Clause
#include "sim/flat_field.h"

#include <gtest/gtest.h>

namespace lsv::sim {
namespace {

SpeckleConfig config_with_pattern() {
  SpeckleConfig out{.width_px = 64, .height_px = 48, .bit_depth = 12, .seed = 3};
  out.noise_mean_counts = 100.0;
  out.mean_signal_counts = 1000.0;
  out.sensor.dsnu_counts = 5.0;
  out.sensor.prnu_ratio = 0.02;
  return out;
}

double mean_of_column(const Frame& frame, int x_px) {
  double sum = 0.0;
  for (int y = 0; y < frame.view().height_px(); ++y) sum += frame.view().at(x_px, y);
  return sum / frame.view().height_px();
}

TEST(FlatFieldCamera, SeesTheSensorOfTheSpeckleCamera) {
  const SpeckleConfig config = config_with_pattern();
  const FlatFieldCamera flat = FlatFieldCamera::create(config).value();
  const SpeckleCamera speckle = SpeckleCamera::create(config).value();
  EXPECT_EQ(flat.pattern().offset_counts, speckle.pattern().offset_counts);
  EXPECT_EQ(flat.pattern().gain_ratio, speckle.pattern().gain_ratio);
}

// A positive gradient is more light at larger columns.
TEST(FlatFieldCamera, TheGradientIsOfTheMean) {
  SpeckleConfig config = config_with_pattern();
  config.sensor = {};
  FlatFieldCamera camera = FlatFieldCamera::create(config, 0.2).value();
  Frame frame;
  ASSERT_TRUE(camera.render(0, frame));
  EXPECT_NEAR(mean_of_column(frame, 0), 100.0 + 900.0, 0.5);
  EXPECT_NEAR(mean_of_column(frame, 63), 100.0 + 1100.0, 0.5);
  EXPECT_NEAR(0.5 * (mean_of_column(frame, 31) + mean_of_column(frame, 32)), 1100.0, 0.5);
  EXPECT_FALSE(FlatFieldCamera::create(config, 1.5));
  EXPECT_FALSE(FlatFieldCamera::create(config, -1.5));
}

TEST(FlatFieldCamera, LevelsOfLightShareNoNoise) {
  SpeckleConfig config = config_with_pattern();
  config.sensor = {};
  config.noise_sd_counts = 4.0;
  Frame first;
  Frame second;
  ASSERT_TRUE(FlatFieldCamera::create(config).value().render(0, first));
  config.mean_signal_counts = 1001.0;
  ASSERT_TRUE(FlatFieldCamera::create(config).value().render(0, second));
  int differences = 0;
  for (int x = 0; x < 64; ++x)
    differences += second.view().at(x, 7) - first.view().at(x, 7) != 1 ? 1 : 0;
  EXPECT_GT(differences, 40);
}

}  // namespace
}  // namespace lsv::sim
