// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/speckle_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/sim/speckle_frames.h"

namespace lsv {
namespace {

constexpr double kSizes_px[] = {1.5, 2.0, 3.0, 3.39, 3.4, 4.0, 6.0, 9.2};
constexpr double kFractions_px[] = {0.0, 0.001, 0.1, 0.25, 0.37, 0.5, 0.7512, 0.9, 1.0};
constexpr double kSingle = 1e-6;  // a few roundings of weights near 1

TEST(SpeckleKernel, WeightsSumToOne) {
  for (const double size : kSizes_px) {
    const SpeckleKernel kernel(size);
    for (const double fraction : kFractions_px) {
      const KernelWeights w = kernel.weights(fraction);
      EXPECT_NEAR(std::accumulate(w.begin(), w.end(), 0.0), 1.0, kSingle)
          << size << " " << fraction;
    }
  }
}

TEST(SpeckleKernel, IsItsOwnMirrorImage) {
  for (const double size : kSizes_px) {
    const SpeckleKernel kernel(size);
    for (const double fraction : kFractions_px) {
      const KernelWeights w = kernel.weights(fraction);
      const KernelWeights mirrored = kernel.weights(1.0 - fraction);
      for (std::size_t j = 0; j < w.size(); ++j)
        EXPECT_NEAR(w[j], mirrored[w.size() - 1 - j], kSingle) << size << " " << fraction;
    }
  }
}

TEST(SpeckleKernel, HasSixTapsForLargeSpeckleOnly) {
  for (const double size : kSizes_px) {
    const SpeckleKernel kernel(size);
    EXPECT_EQ(kernel.has_six_taps(), size >= SpeckleKernel::kSixTapFwhm_px) << size;
    const KernelWeights w = kernel.weights(0.5);
    EXPECT_EQ(w.front() == 0.0F && w.back() == 0.0F, kernel.has_six_taps()) << size;
    EXPECT_NE(w[1], 0.0F) << size;
  }
}

/// Noise-free light of mean 1 and spread 1, with a margin on either side of each row.
class Light {
 public:
  static constexpr int kColumns = 120;
  static constexpr int kRows = 48;

  Light(double speckle_px, double x_px) {
    sim::SpeckleConfig config;
    config.width_px = kColumns + 2 * kMargin_px;
    config.height_px = kRows;
    config.speckle_px = speckle_px;
    config.seed = 7;
    auto camera = sim::make_camera(config);
    light_ = sim::light(camera, 0, {.x_px = x_px});
  }

  double at(int x, int y) const {
    return light_[static_cast<std::size_t>(y * (kColumns + 2 * kMargin_px) + x + kMargin_px)];
  }

  double interpolated(const KernelWeights& weights, int x, int y) const {
    double out = 0.0;
    for (int j = 0; j < kKernelTaps; ++j)
      out += weights[static_cast<std::size_t>(j)] * at(x + j - kKernelLeft_px, y);
    return out;
  }

 private:
  static constexpr int kMargin_px = kKernelRight_px;
  std::vector<double> light_;
};

/// Of error(x, y) over all pixels.
template <class Error>
double rms(const Error& error) {
  double squares = 0.0;
  for (int y = 0; y < Light::kRows; ++y) {
    for (int x = 0; x < Light::kColumns; ++x) squares += std::pow(error(x, y), 2);
  }
  return std::sqrt(squares / (Light::kRows * Light::kColumns));
}

struct Errors {
  double kernel = 0.0;
  double line = 0.0;
};

/// The pattern moved to the left by the fraction stands where the kernel should find it.
Errors interpolation_errors(const Light& light, double speckle_px, double fraction_px) {
  const Light truth(speckle_px, -fraction_px);
  const KernelWeights w = speckle_kernel(speckle_px).weights(fraction_px);
  return {.kernel = rms([&](int x, int y) { return light.interpolated(w, x, y) - truth.at(x, y); }),
          .line = rms([&](int x, int y) {
            return (1.0 - fraction_px) * light.at(x, y) + fraction_px * light.at(x + 1, y) -
                   truth.at(x, y);
          })};
}

TEST(SpeckleKernel, InterpolatesSpeckleOfFourPixelsFiftyTimesBetterThanALine) {
  const Light light(4.0, 0.0);
  for (const double fraction : {0.25, 0.5, 0.8}) {
    const Errors errors = interpolation_errors(light, 4.0, fraction);
    EXPECT_LT(50.0 * errors.kernel, errors.line) << fraction;
  }
}

// Finer speckle has detail that eight pixels do not hold; on larger speckle a line does well, too.
TEST(SpeckleKernel, InterpolatesEverySpeckleFarBetterThanALine) {
  for (const double speckle_px : {3.0, 3.5, 5.0, 6.0, 8.0}) {
    const Light light(speckle_px, 0.0);
    for (const double fraction : {0.25, 0.5, 0.8}) {
      const Errors errors = interpolation_errors(light, speckle_px, fraction);
      EXPECT_LT(25.0 * errors.kernel, errors.line) << speckle_px << " " << fraction;
      EXPECT_LT(errors.kernel, 3e-3) << speckle_px << " " << fraction;
    }
  }
}

// Not exact: the weights expect a little noise in the pixel itself and ask its neighbours as well.
TEST(SpeckleKernel, TakesThePixelItselfAtWholePixels) {
  for (const double speckle_px : {2.0, 3.0, 4.0, 6.0, 9.0}) {
    const Light light(speckle_px, 0.0);
    for (const int whole : {0, 1}) {
      const KernelWeights w = speckle_kernel(speckle_px).weights(whole);
      EXPECT_LT(
          rms([&](int x, int y) { return light.interpolated(w, x, y) - light.at(x + whole, y); }),
          2e-3)
          << speckle_px << " " << whole;
    }
  }
}

TEST(SpeckleKernel, DerivativeOfARampIsOne) {
  for (const double size : kSizes_px) {
    const SpeckleKernel kernel(size);
    double slope = 0.0;
    for (int j = 1; j <= kGradientReach_px; ++j)
      slope += 2.0 * j * kernel.derivative_1_px()[static_cast<std::size_t>(j - 1)];
    EXPECT_NEAR(slope, 1.0, kSingle) << size;
  }
}

TEST(SpeckleKernel, DerivativeOfSpeckleIsItsSlope) {
  constexpr double kStep_px = 0.01;
  for (const double speckle_px : {3.0, 4.0, 6.0}) {
    const Light light(speckle_px, 0.0);
    const Light to_left(speckle_px, -kStep_px), to_right(speckle_px, kStep_px);
    const auto& weights = speckle_kernel(speckle_px).derivative_1_px();
    const auto slope = [&](int x, int y) {
      return (to_left.at(x, y) - to_right.at(x, y)) / (2.0 * kStep_px);
    };
    const double error = rms([&](int x, int y) {
      double derivative = 0.0;
      for (int j = 1; j <= kGradientReach_px; ++j)
        derivative +=
            weights[static_cast<std::size_t>(j - 1)] * (light.at(x + j, y) - light.at(x - j, y));
      return derivative - slope(x, y);
    });
    EXPECT_LT(error, 0.03 * rms(slope)) << speckle_px;
  }
}

TEST(SpeckleKernelSet, TheNextSmallerSizeIsChosen) {
  double last_px = 0.0;
  int sizes = 0;
  for (double wanted_px = 1.5; wanted_px < 12.0; wanted_px += 0.01) {
    const double size_px = speckle_kernel(wanted_px).fwhm_px();
    EXPECT_LE(size_px, wanted_px);
    EXPECT_GE(size_px, last_px);
    EXPECT_GT(size_px, std::min(wanted_px, 9.0) / 1.16);
    // Of a size in the set itself, the kernel made for it.
    EXPECT_EQ(speckle_kernel(size_px).fwhm_px(), size_px);
    if (size_px > last_px) ++sizes;
    last_px = size_px;
  }
  EXPECT_EQ(sizes, 14);
}

TEST(SpeckleKernelSet, EndsAreTakenForWhatLiesBeyond) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double size_px : {-1.0, 0.0, 1.49, std::nan("")})
    EXPECT_EQ(speckle_kernel(size_px).fwhm_px(), 1.5) << size_px;
  EXPECT_NEAR(speckle_kernel(kInfinity).fwhm_px(), 9.2, 0.1);
}

TEST(SpeckleSize, FollowsFromTheCurvatureOfTheAutocovariance) {
  for (const double variance_px2 : {0.5, 2.9, 10.0}) {
    const double fwhm_px = speckle_fwhm_px(variance_px2);
    const auto airy = [](double x) { return std::pow(2.0 * std::cyl_bessel_j(1.0, x) / x, 2); };
    // (2 J1(x) / x)^2 = 1/2 at half the full width.
    constexpr double kHalf = 1.61634;
    EXPECT_NEAR(airy(kHalf), 0.5, 1e-5);
    const double lag_px = 0.02 * fwhm_px;
    EXPECT_NEAR(std::log(airy(2.0 * kHalf * lag_px / fwhm_px)),
                -0.5 * lag_px * lag_px / variance_px2, 1e-6);
  }
}

}  // namespace
}  // namespace lsv
