// SPDX-License-Identifier: BSD-3-Clause
// The light is fully developed speckle of the size asked for. Bounds are five standard errors for
// the number of independent speckles seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lsv/core/shift.h"
#include "tests/sim/speckle_frames.h"

namespace lsv::sim {
namespace {

constexpr int kSide_px = 256;
constexpr int kFrames = 12;

SpeckleConfig light_only(double speckle_px, std::uint64_t seed) {
  SpeckleConfig config;
  config.width_px = kSide_px;
  config.height_px = kSide_px;
  config.speckle_px = speckle_px;
  config.pixel_side_px = 0.0;
  config.seed = seed;
  return config;
}

/// Light of kFrames independent places.
std::vector<std::vector<double>> places(const SpeckleConfig& config) {
  SpeckleCamera camera = make_camera(config);
  std::vector<std::vector<double>> images;
  for (int n = 0; n < kFrames; ++n)
    images.push_back(light(camera, n, {1000.25 * n, 0.4 * n, 0.0, 0.0}));
  return images;
}

/// Autocovariance of the intensity at a lag, relative to the variance 1 and mean 1 of theory.
double autocovariance(const std::vector<std::vector<double>>& images, int dx_px, int dy_px) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& image : images) {
    for (int y = 0; y + dy_px < kSide_px; ++y) {
      for (int x = 0; x + dx_px < kSide_px; ++x) {
        const double a = image[static_cast<std::size_t>(y * kSide_px + x)] - 1.0;
        const double b = image[static_cast<std::size_t>((y + dy_px) * kSide_px + x + dx_px)] - 1.0;
        sum += a * b;
        ++count;
      }
    }
  }
  return sum / static_cast<double>(count);
}

TEST(SpeckleStatistics, IntensityIsExponentialWithContrastOne) {
  const auto images = places(light_only(4.0, 11));
  std::vector<double> all;
  for (const auto& image : images) all.insert(all.end(), image.begin(), image.end());
  const double speckles = speckle_count(static_cast<double>(all.size()), 4.0);
  const double five_sigma = 5.0 / std::sqrt(speckles);
  EXPECT_NEAR(mean(all), 1.0, five_sigma);
  EXPECT_NEAR(standard_deviation(all) / mean(all), 1.0, 1.5 * five_sigma);
  for (const double level : {0.1, 0.5, 1.0, 2.0, 4.0}) {
    const auto above = std::count_if(all.begin(), all.end(), [&](double v) { return v > level; });
    const double expected = std::exp(-level);
    EXPECT_NEAR(static_cast<double>(above) / static_cast<double>(all.size()), expected,
                five_sigma * std::sqrt(expected * (1.0 - expected)))
        << "level " << level;
  }
}

TEST(SpeckleStatistics, AutocovarianceIsThatOfACircularAperture) {
  constexpr double kSpeckle_px = 5.0;
  const auto images = places(light_only(kSpeckle_px, 12));
  const double five_sigma =
      5.0 / std::sqrt(speckle_count(double{kFrames} * kSide_px * kSide_px, kSpeckle_px));
  const double at_0 = autocovariance(images, 0, 0);
  for (int dy_px = 0; dy_px <= 10; ++dy_px) {
    for (int dx_px = 0; dx_px <= 10; ++dx_px) {
      if (dx_px + dy_px == 0) continue;
      const double x =
          std::numbers::pi * std::hypot(dx_px, dy_px) * kHardApertureFwhm / kSpeckle_px;
      const double expected = std::pow(2.0 * ::j1(x) / x, 2);
      EXPECT_NEAR(autocovariance(images, dx_px, dy_px) / at_0, expected, 0.003 + five_sigma)
          << "lag " << dx_px << "," << dy_px;
    }
  }
}

/// Full width at half maximum along one axis: r(sqrt(-ln C)) is nearly a straight line there.
double width_at_half(const std::vector<std::vector<double>>& images, int along_x, int along_y) {
  const double at_0 = autocovariance(images, 0, 0);
  double before = 0.0;
  for (int lag = 1; lag < 40; ++lag) {
    const double c = autocovariance(images, lag * along_x, lag * along_y) / at_0;
    const double root = std::sqrt(-std::log(c));
    const double half = std::sqrt(std::numbers::ln2);
    if (root >= half) return 2.0 * (lag - 1 + (half - before) / (root - before));
    before = root;
  }
  return kUnknown;
}

TEST(SpeckleStatistics, TheWidthIsTheSetting) {
  for (const double speckle_px : {2.0, 3.0, 4.5, 8.0}) {
    const auto images = places(light_only(speckle_px, 13));
    EXPECT_NEAR(width_at_half(images, 1, 0) / speckle_px, 1.0, 0.03) << speckle_px;
    EXPECT_NEAR(width_at_half(images, 0, 1) / speckle_px, 1.0, 0.03) << speckle_px;
  }
}

TEST(SpeckleStatistics, NewGroundAndOtherSeedsAreUncorrelated) {
  SpeckleCamera camera = make_camera(light_only(4.0, 14));
  SpeckleCamera other = make_camera(light_only(4.0, 15));
  const double five_sigma = 5.0 / std::sqrt(speckle_count(double{kSide_px} * kSide_px, 4.0));
  const auto here = light(camera, 0, {});
  EXPECT_LT(std::abs(correlation(here, light(camera, 1, {1000.0, 0.0, 0.0, 0.0}))), five_sigma);
  EXPECT_LT(std::abs(correlation(here, light(camera, 2, {0.0, -1000.0, 0.0, 0.0}))), five_sigma);
  EXPECT_LT(std::abs(correlation(here, light(camera, 3, {65536.0, 0.0, 0.0, 0.0}))), five_sigma);
  EXPECT_LT(std::abs(correlation(here, light(other, 0, {}))), five_sigma);
}

TEST(SpeckleStatistics, BoilingHasTheCorrelationAskedFor) {
  constexpr double kRho = 0.9;
  SpeckleConfig config = light_only(4.0, 16);
  config.rho = kRho;
  SpeckleCamera camera = make_camera(config);
  std::vector<std::vector<double>> images;
  for (int frame = 0; frame <= 8; ++frame) images.push_back(light(camera, frame, {}));
  const double five_sigma = 5.0 / std::sqrt(speckle_count(double{kSide_px} * kSide_px, 4.0));
  for (const std::size_t n : {1U, 2U, 8U}) {
    const double expected = std::pow(kRho, n);
    // The error of a correlation coefficient shrinks as the coefficient nears 1.
    EXPECT_NEAR(correlation(images[0], images[n]), expected,
                five_sigma * std::sqrt(1.0 - expected * expected))
        << n << " frames";
  }
  EXPECT_NEAR(mean(images[8]), 1.0, five_sigma);
  EXPECT_NEAR(standard_deviation(images[8]), 1.0, 3.0 * five_sigma);
}

TEST(SpeckleStatistics, BoilingGoesOnWhileThePatternIsAway) {
  constexpr double kRho = 0.97;
  SpeckleConfig config = light_only(4.0, 17);
  config.rho = kRho;
  SpeckleCamera camera = make_camera(config);
  const auto before = light(camera, 0, {});
  light(camera, 9, {3000.0, 0.0, 0.0, 0.0});
  const auto moved_back = light(camera, 10, {0.0, 0.0, 0.0, 0.0});
  const double expected = std::pow(kRho, 10);
  const double five_sigma = 5.0 / std::sqrt(speckle_count(double{kSide_px} * kSide_px, 4.0));
  EXPECT_NEAR(correlation(before, moved_back), expected, five_sigma);
}

TEST(SpeckleStatistics, WithoutMemoryEveryFrameIsNew) {
  SpeckleConfig config = light_only(4.0, 18);
  config.rho = 0.0;
  SpeckleCamera camera = make_camera(config);
  const auto first = light(camera, 0, {});
  const double five_sigma = 5.0 / std::sqrt(speckle_count(double{kSide_px} * kSide_px, 4.0));
  EXPECT_LT(std::abs(correlation(first, light(camera, 1, {}))), five_sigma);
}

}  // namespace
}  // namespace lsv::sim
