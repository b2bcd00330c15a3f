// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/smooth_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lsv {
namespace {

constexpr int kWidth = 70;
constexpr int kHeight = 45;
constexpr std::size_t kPixels = kWidth * kHeight;

template <typename Value>
std::vector<double> picture(Value value) {
  std::vector<double> out(kPixels);
  for (std::size_t i = 0; i < kPixels; ++i)
    out[i] = value(static_cast<double>(i % kWidth), static_cast<double>(i / kWidth));
  return out;
}

double worst(const std::vector<double>& a, const std::vector<double>& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, std::abs(a[i] - b[i]));
  return out;
}

// A slope, or the fall of a lens towards the corners, is light, up to the last pixel of the border.
TEST(SmoothPart, SlopesAndVignettingAreLightUpToTheBorder) {
  const std::vector<double> light = picture([](double x, double y) {
    const double u = (x - 30.0) / 40.0;
    const double v = (y - 25.0) / 30.0;
    return 200.0 + 3.0 * u - 20.0 * u * u - 11.0 * v * v - 4.0 * u * u * v * v + 2.0 * v * v * v;
  });
  const std::vector<std::uint8_t> none(kPixels);
  EXPECT_LT(worst(smooth_part(light, none, kWidth, kHeight), light), 1e-9);
}

TEST(SmoothPart, DefectsAreLeftOut) {
  std::vector<double> light = picture([](double x, double y) { return 100.0 + 0.3 * x - 0.2 * y; });
  std::vector<double> spoilt = light;
  std::vector<std::uint8_t> defect(kPixels);
  std::mt19937_64 random(6);
  for (int k = 0; k < 300; ++k) {
    const std::size_t i = random() % kPixels;
    spoilt[i] = 1e4;
    defect[i] = 1;
  }
  EXPECT_LT(worst(smooth_part(spoilt, defect, kWidth, kHeight), light), 1e-9);
}

// The pattern of the pixels is not light: what is left of it is what high_pass_gain() says.
TEST(SmoothPart, APatternOfPixelsIsLeft) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double left = 0.0;
  double whole = 0.0;
  const std::vector<std::uint8_t> none(kPixels);
  for (int k = 0; k < 30; ++k) {
    std::vector<double> pattern(kPixels);
    for (double& value : pattern) value = normal(random);
    const std::vector<double> smooth = smooth_part(pattern, none, kWidth, kHeight);
    for (std::size_t i = 0; i < kPixels; ++i) {
      whole += pattern[i] * pattern[i];
      left += std::pow(pattern[i] - smooth[i], 2.0);
    }
  }
  std::printf("left of a pattern: %.5f, expected %.5f\n", std::sqrt(left / whole),
              high_pass_gain());
  // Along the borders the filter has fewer pixels and takes a little more.
  EXPECT_NEAR(std::sqrt(left / whole), high_pass_gain(), 0.005);
  EXPECT_NEAR(high_pass_gain(), 0.9943, 1e-4);
}

// A shadow much wider than the filter is light; one of a few pixels is not.
TEST(SmoothPart, WideShadowsAreLightSmallOnesAreNot) {
  const auto shadow = [](double width) {
    return picture([width](double x, double y) {
      return -std::exp(-0.5 * (std::pow(x - 35.0, 2.0) + std::pow(y - 22.0, 2.0)) /
                       (width * width));
    });
  };
  const std::vector<std::uint8_t> none(kPixels);
  const std::size_t middle = 22 * kWidth + 35;
  EXPECT_LT(smooth_part(shadow(12.0), none, kWidth, kHeight)[middle], -0.9);
  EXPECT_GT(smooth_part(shadow(1.0), none, kWidth, kHeight)[middle], -0.15);
}

}  // namespace
}  // namespace lsv
