// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/quality.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lsv {
namespace {

/// A plane that is `level` everywhere, with values set by hand.
CorrelationPlane flat_plane(float level) {
  CorrelationPlane plane{.lags = {10, 8}, .values = AlignedBuffer<float>(21 * 17)};
  for (float& value : plane.values.span()) value = level;
  return plane;
}

float& lag(CorrelationPlane& plane, int dx, int dy) {
  return plane.values[static_cast<std::size_t>((dy + 8) * 21 + dx + 10)];
}

Peak peak_at(int dx, int dy, double value) {
  Peak peak;
  peak.status = ShiftStatus::ok;
  peak.lag_dx_px = dx;
  peak.lag_dy_px = dy;
  peak.lag_value = value;
  peak.value = value;
  peak.shape = {.xx_px2 = 1.0, .xy_px2 = 0.0, .yy_px2 = 1.0};
  return peak;
}

TEST(MeasureQuality, MatchesItsDefinition) {
  CorrelationPlane plane = flat_plane(-0.1F);
  lag(plane, 2, -3) = 0.9F;
  lag(plane, -7, 4) = 0.3F;
  const ShiftQuality q = measure_quality(plane, peak_at(2, -3, 0.9F), 4000.0);
  const double lags = 21.0 * 17.0;
  const double mean_abs = (0.9 + 0.3 + 0.1 * (lags - 2.0)) / lags;
  EXPECT_NEAR(q.q, 0.9 / mean_abs, 1e-5);
  EXPECT_NEAR(q.peak_ratio, 3.0, 1e-5);
  const double outside = lags - 49.0;  // the peak is 3 sigma = 3 px to each side
  EXPECT_NEAR(q.peak_to_rms, 0.9 / std::sqrt((0.09 + 0.01 * (outside - 1.0)) / outside), 1e-4);
  EXPECT_NEAR(q.zncc, 0.9, 1e-6);
  EXPECT_NEAR(q.zncc_sigmas, 0.9 / std::sqrt(3.14159265 / 4000.0), 1e-4);
}

TEST(MeasureQuality, ASecondPeakCountsOnlyOutsideTheFirst) {
  for (const auto& [dx, expected_ratio] : {std::pair{5, 9.0}, {6, 1.125}}) {
    CorrelationPlane plane = flat_plane(0.1F);
    lag(plane, 2, 0) = 0.9F;
    lag(plane, dx, 0) = 0.8F;  // 3 px off: inside; 4 px off: outside
    EXPECT_NEAR(measure_quality(plane, peak_at(2, 0, 0.9F), 4000.0).peak_ratio, expected_ratio,
                1e-4);
  }
}

TEST(MeasureQuality, IsFiniteWhenNothingElseIsPositive) {
  CorrelationPlane plane = flat_plane(-0.01F);
  lag(plane, 0, 0) = 1.0F;
  const ShiftQuality q = measure_quality(plane, peak_at(0, 0, 1.0), 4000.0);
  EXPECT_TRUE(std::isfinite(q.peak_ratio));
  EXPECT_GE(q.peak_ratio, 1.0);
}

TEST(MeasureQuality, ZeroPlaneIsUnknownNotInfinite) {
  const ShiftQuality q = measure_quality(flat_plane(0.0F), peak_at(0, 0, 0.0), 4000.0);
  EXPECT_TRUE(std::isnan(q.q));
  EXPECT_TRUE(std::isnan(q.peak_ratio));
}

FrameStats bright() { return {.mean_counts = 60.0, .sd_counts = 45.0, .saturated_fraction = 0.0}; }

TEST(ShiftCovariance, FollowsTheShapeOfThePeak) {
  Peak peak = peak_at(0, 0, 0.99);
  peak.shape = {.xx_px2 = 4.0, .xy_px2 = 0.5, .yy_px2 = 1.0};
  const ShiftCovariance cov = shift_covariance(peak, 0.99, bright(), bright(), 16384.0, {});
  EXPECT_GT(cov.xx_px2, 2.0 * cov.yy_px2);
  EXPECT_GT(cov.xy_px2, 0.0);
  EXPECT_GT(cov.xx_px2 * cov.yy_px2, cov.xy_px2 * cov.xy_px2);
  EXPECT_GT(cov.yy_px2, 0.0);
}

TEST(ShiftCovariance, GrowsWithDecorrelationAndNoiseAndShrinksWithPixels) {
  const Peak peak = peak_at(0, 0, 0.9);
  const auto variance = [&](double zncc, double pixels, double noise_sd) {
    return shift_covariance(peak, zncc, bright(), bright(), pixels,
                            {.noise_sd_counts = noise_sd, .fit = PeakFit::gaussian2d})
        .xx_px2;
  };
  EXPECT_GT(variance(0.8, 16384, 0.5), variance(0.9, 16384, 0.5));
  EXPECT_NEAR(variance(0.9, 4096, 0.5) / variance(0.9, 16384, 0.5), 4.0, 0.2);
  EXPECT_GT(variance(1.0, 16384, 5.0), variance(1.0, 16384, 0.5));
}

// Low correlation that camera noise explains is not charged as decorrelation.
TEST(ShiftCovariance, DoesNotChargeCameraNoiseTwice) {
  const FrameStats dim{.mean_counts = 12.0, .sd_counts = 8.0, .saturated_fraction = 0.0};
  const Peak peak = peak_at(0, 0, 0.94);
  const double zncc = (64.0 - 4.0) / 64.0;
  const double informed = shift_covariance(peak, zncc, dim, dim, 16384.0,
                                           {.noise_sd_counts = 2.0, .fit = PeakFit::gaussian2d})
                              .xx_px2;
  const double ignorant = shift_covariance(peak, zncc, dim, dim, 16384.0,
                                           {.noise_sd_counts = 0.0, .fit = PeakFit::gaussian2d})
                              .xx_px2;
  EXPECT_LT(informed, 0.5 * ignorant);
}

}  // namespace
}  // namespace lsv
