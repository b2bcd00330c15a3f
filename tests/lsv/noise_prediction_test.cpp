// SPDX-License-Identifier: BSD-3-Clause
// The noise that calibration/noise_model.h predicts against that of simulated, tracked frames, at
// conditions that its table was not made from. Few pairs here; bench/noise_check takes ten times as
// many and must hold without the allowance for chance.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>

#include "bench/noise_points.h"

namespace lsv {
namespace {

constexpr int kPairs = 64;
constexpr int kLargePairs = 32;  // of windows that take long to simulate
constexpr int kLargeWindow_px = 192;
constexpr double kAllowed_ratio = 0.15;
constexpr double kChanceSigmas = 3.0;

class NoisePrediction12 : public testing::TestWithParam<bench::NoisePoint> {};

TEST_P(NoisePrediction12, HoldsOnTrackedFrames) {
  cv::setNumThreads(1);
  const bench::NoisePoint& point = GetParam();
  const NoisePrediction predicted = predict_noise(bench::conditions_of(point));
  ASSERT_EQ(predicted.range, NoiseRange::inside) << advice(predicted.range);
  const bench::PairErrors errors =
      bench::simulate(point, point.side_px < kLargeWindow_px ? kPairs : kLargePairs);
  EXPECT_EQ(errors.outliers, 0);
  const double x = errors.rmse_x_px() / predicted.sigma_x_px;
  const double y = errors.rmse_y_px() / predicted.sigma_y_px;
  // The standard error of a root of the mean square of n normal numbers is 1 / sqrt(2 n) of it.
  const double both = std::sqrt(0.5 * (x * x + y * y));
  const double chance = kChanceSigmas / std::sqrt(2.0 * 2.0 * errors.good());
  std::printf("predicted %.3f %.3f mpx, simulated %.3f %.3f mpx: ratio %.3f, allowed 1 +- %.3f\n",
              1e3 * predicted.sigma_x_px, 1e3 * predicted.sigma_y_px, 1e3 * errors.rmse_x_px(),
              1e3 * errors.rmse_y_px(), both, kAllowed_ratio + chance);
  EXPECT_NEAR(both, 1.0, kAllowed_ratio + chance);
}

std::string name_of(const testing::TestParamInfo<bench::NoisePoint>& info) {
  return "point_" + std::to_string(info.index + 1);
}

INSTANTIATE_TEST_SUITE_P(Points, NoisePrediction12, testing::ValuesIn(bench::noise_points()),
                         name_of);

}  // namespace
}  // namespace lsv
