// SPDX-License-Identifier: BSD-3-Clause
// Exactness: the field is one fixed function of ground position, whichever way it is computed.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "sim/philox.h"
#include "tests/sim/speckle_frames.h"

namespace lsv::sim {
namespace {

constexpr std::uint64_t kSeed = 20240607;

SpeckleConfig point_samples(int width_px, int height_px, double speckle_px) {
  SpeckleConfig config;
  config.width_px = width_px;
  config.height_px = height_px;
  config.speckle_px = speckle_px;
  config.pixel_side_px = 0.0;
  config.seed = kSeed;
  return config;
}

/// |field|^2 at ground position (x, y), in samples of aperture scale s, by its definition: the
/// sum over the lattice of site times point spread. Shares only the two closed forms.
double intensity_by_direct_sum(double x, double y, double s) {
  const int reach = static_cast<int>(std::ceil(kKernelRadius * s)) + 1;
  std::complex<double> field;
  double energy = 0.0;
  for (auto j = std::llround(y) - reach; j <= std::llround(y) + reach; ++j) {
    for (auto i = std::llround(x) - reach; i <= std::llround(x) + reach; ++i) {
      const double h =
          point_spread(std::hypot(x - static_cast<double>(i), y - static_cast<double>(j)), s);
      field += h * complex_normal(kSeed, Stream::ground, i, j, 0);
      energy += h * h;
    }
  }
  return std::norm(field) / energy;
}

TEST(SpeckleField, AgreesWithTheDirectSumAtSubPixelPositions) {
  constexpr PatternMotion kMotion{-1234.3719, 77.8125, 0.0, 0.0};
  for (const auto& [speckle_px, samples_per_px] :
       {std::pair{4.0, 1}, std::pair{6.5, 1}, std::pair{2.0, 2}, std::pair{1.2, 3}}) {
    SpeckleCamera camera = make_camera(point_samples(40, 24, speckle_px));
    const std::vector<double> image = light(camera, 0, kMotion);
    const double s = speckle_px / kSoftApertureFwhm * samples_per_px;
    for (const auto& [x_px, y_px] : {std::pair{0, 0}, std::pair{39, 0}, std::pair{17, 23}}) {
      const double expected = intensity_by_direct_sum((x_px - kMotion.x_px) * samples_per_px,
                                                      (y_px - kMotion.y_px) * samples_per_px, s);
      EXPECT_NEAR(image[static_cast<std::size_t>(y_px * 40 + x_px)], expected, 1e-5)
          << "speckle " << speckle_px << " px at " << x_px << "," << y_px;
    }
  }
}

TEST(SpeckleField, AnIntegerShiftMovesThePixels) {
  constexpr int kSide = 48;
  SpeckleConfig config = point_samples(kSide, kSide, 3.7);
  config.pixel_side_px = 1.0;
  SpeckleCamera camera = make_camera(config);
  const std::vector<double> before = light(camera, 0, {0.375, -0.625, 0.0, 0.0});
  constexpr int kDx_px = 7;
  constexpr int kDy_px = -3;
  const std::vector<double> after = light(camera, 1, {0.375 + kDx_px, -0.625 + kDy_px, 0.0, 0.0});
  double largest = 0.0;
  for (int y = 3; y < kSide; ++y) {
    for (int x = 0; x < kSide - kDx_px; ++x) {
      const double a = before[static_cast<std::size_t>(y * kSide + x)];
      const double b = after[static_cast<std::size_t>((y + kDy_px) * kSide + x + kDx_px)];
      largest = std::max(largest, std::abs(a - b));
    }
  }
  EXPECT_LT(largest, 1e-5);
}

// Half a pixel is where the patch moves on by one site and the phase ramp changes sign. Over
// 2.8e-6 px the steepest speckle changes by a few 1e-6.
TEST(SpeckleField, IsContinuousWhereTheLatticeCellChanges) {
  SpeckleCamera camera = make_camera(point_samples(32, 32, 4.0));
  constexpr double kStep_px = 1e-6;
  const auto left = light(camera, 0, {0.5 - kStep_px, 0.5 - kStep_px, 0.0, 0.0});
  const auto right = light(camera, 0, {0.5 + kStep_px, 0.5 + kStep_px, 0.0, 0.0});
  EXPECT_LT(largest_difference(left, right), 2e-5);
}

TEST(SpeckleField, ThereAndBackGivesTheSameFrameToTheByte) {
  SpeckleConfig config = point_samples(64, 32, 4.0);
  config.noise_sd_counts = 0.0;
  SpeckleCamera camera = make_camera(config);
  const PatternMotion here{3.3, -1.7, 0.0, 0.0};
  const auto before = light(camera, 5, here);
  light(camera, 6, {812.1, 40.0, 0.0, 0.0});
  EXPECT_EQ(light(camera, 7, here), before);
}

TEST(SpeckleField, FarFromTheStartItIsAsExact) {
  SpeckleCamera camera = make_camera(point_samples(16, 16, 4.0));
  const auto image = light(camera, 0, {9.0e7 + 0.25, -9.0e7, 0.0, 0.0});
  EXPECT_NEAR(image[0], intensity_by_direct_sum(-9.0e7 - 0.25, 9.0e7, 4.0 / kSoftApertureFwhm),
              2e-5);
}

TEST(SpeckleField, PixelIntegrationIsTheMeanOverThePixelSquare) {
  // Gauss-Legendre, 5 points on [-1/2, 1/2]: exact to degree 9.
  constexpr std::array kNodes = {-0.4530899229693320, -0.2692346550528416, 0.0, 0.2692346550528416,
                                 0.4530899229693320};
  constexpr std::array kWeights = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                   0.2393143352496832, 0.1184634425280945};
  for (const double speckle_px : {1.0, 2.0, 3.0, 4.0, 7.0}) {
    for (const double side_px : {1.0, 0.7}) {
      SpeckleConfig config = point_samples(24, 20, speckle_px);
      SpeckleCamera points = make_camera(config);
      config.pixel_side_px = side_px;
      SpeckleCamera pixels = make_camera(config);
      const PatternMotion motion{0.2, 0.4, 0.0, 0.0};
      std::vector<double> expected(24 * 20, 0.0);
      for (std::size_t j = 0; j < kNodes.size(); ++j) {
        for (std::size_t i = 0; i < kNodes.size(); ++i) {
          const auto image = light(
              points, 0,
              {motion.x_px - side_px * kNodes[i], motion.y_px - side_px * kNodes[j], 0.0, 0.0});
          for (std::size_t n = 0; n < image.size(); ++n)
            expected[n] += kWeights[i] * kWeights[j] * image[n];
        }
      }
      EXPECT_LT(largest_difference(light(pixels, 0, motion), expected), 1e-4)
          << "speckle " << speckle_px << " px, pixel side " << side_px << " px";
    }
  }
}

TEST(SpeckleField, BlurIsTheMeanAlongThePathOfTheExposure) {
  for (const auto& [vx_px, vy_px] :
       {std::pair{5.0, -2.0}, std::pair{0.3, 0.0}, std::pair{-20.0, 11.0}}) {
    SpeckleConfig config = point_samples(24, 24, 4.0);
    SpeckleCamera still = make_camera(config);
    config.exposure_ratio = 0.7;
    SpeckleCamera moving = make_camera(config);
    constexpr int kSteps = 2000;
    std::vector<double> expected(24 * 24, 0.0);
    for (int n = 0; n < kSteps; ++n) {
      const double t = 0.7 * ((n + 0.5) / kSteps - 0.5);
      const auto image = light(still, 0, {1.5 + vx_px * t, 2.5 + vy_px * t, 0.0, 0.0});
      for (std::size_t k = 0; k < image.size(); ++k) expected[k] += image[k] / kSteps;
    }
    const auto blurred = light(moving, 0, {1.5, 2.5, vx_px, vy_px});
    EXPECT_LT(largest_difference(blurred, expected), 2e-5) << vx_px << "," << vy_px;
  }
}

// The widths from the transfer function: Hankel transform of the point spread, then of its square.
TEST(SpeckleOptics, TheWidthConstantsAreThoseOfTheApertures) {
  constexpr double kPi = std::numbers::pi;
  constexpr int kRadii = 3000;
  constexpr int kFrequencies = 800;
  constexpr double kStep_r = kKernelRadius / kRadii;
  constexpr double kStep_f = 0.8 / kFrequencies;
  std::array<double, kFrequencies> power{};
  for (int j = 0; j < kFrequencies; ++j) {
    double transfer = 0.0;
    for (int i = 0; i < kRadii; ++i) {
      const double r = (i + 0.5) * kStep_r;
      transfer += point_spread(r, 1.0) * r * ::j0(2.0 * kPi * (j + 0.5) * kStep_f * r);
    }
    power[static_cast<std::size_t>(j)] = transfer * transfer;
  }
  const auto soft_autocovariance = [&](double r) {
    double at_r = 0.0;
    double at_0 = 0.0;
    for (int j = 0; j < kFrequencies; ++j) {
      const double f = (j + 0.5) * kStep_f;
      at_r += power[static_cast<std::size_t>(j)] * f * ::j0(2.0 * kPi * f * r);
      at_0 += power[static_cast<std::size_t>(j)] * f;
    }
    return std::pow(at_r / at_0, 2);
  };
  EXPECT_NEAR(soft_autocovariance(kSoftApertureFwhm / 2.0), 0.5, 1e-5);
  const double x = kPi * kHardApertureFwhm / 2.0;
  EXPECT_NEAR(std::pow(2.0 * ::j1(x) / x, 2), 0.5, 1e-6);
}

TEST(SpeckleOptics, ExposureNodesIntegratePolynomials) {
  for (const double path : {0.1, 3.0, 40.0}) {
    double area = 0.0;
    double second_moment = 0.0;
    double odd_moment = 0.0;
    for (const auto& [t, weight] : exposure_nodes(path, 4.0)) {
      area += weight;
      second_moment += weight * t * t;
      odd_moment += weight * t * t * t;
    }
    EXPECT_NEAR(area, 1.0, 1e-12);
    EXPECT_NEAR(second_moment, 1.0 / 12.0, 1e-12);
    EXPECT_NEAR(odd_moment, 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace lsv::sim
