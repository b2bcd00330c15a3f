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

/// Wide enough (6 px speckle) that the terms of the peak model are small.
Peak wide_peak() {
  Peak peak = peak_at(0, 0, 0.9);
  peak.shape = {.xx_px2 = 8.0, .xy_px2 = 1.0, .yy_px2 = 4.0};
  return peak;
}

double variance_x_px2(double zncc, const FrameStats& stats, double pixels, double noise_sd) {
  return shift_error(wide_peak(), zncc, stats, stats, pixels, {.noise_sd_counts = noise_sd})
      .cov.xx_px2;
}

TEST(ShiftCovariance, FollowsTheShapeOfThePeak) {
  const ShiftCovariance cov = shift_error(wide_peak(), 0.9, bright(), bright(), 16384.0, {}).cov;
  EXPECT_NEAR(cov.xx_px2 / cov.yy_px2, 2.0, 0.05);
  EXPECT_NEAR(cov.xy_px2 / cov.xx_px2, 0.125, 0.01);
}

TEST(ShiftCovariance, GrowsWithDecorrelationAndNoiseAndShrinksWithPixels) {
  EXPECT_GT(variance_x_px2(0.8, bright(), 16384, 0.5), variance_x_px2(0.9, bright(), 16384, 0.5));
  EXPECT_NEAR(variance_x_px2(0.9, bright(), 4096, 0.5) / variance_x_px2(0.9, bright(), 16384, 0.5),
              4.0, 0.01);
  EXPECT_GT(variance_x_px2(1.0, bright(), 16384, 5.0), variance_x_px2(1.0, bright(), 16384, 0.5));
}

// Low correlation that camera noise explains is not charged as decorrelation.
TEST(ShiftCovariance, DoesNotChargeCameraNoiseTwice) {
  const FrameStats dim{.mean_counts = 12.0, .sd_counts = 8.0, .saturated_fraction = 0.0};
  const double zncc = (64.0 - 4.0) / 64.0;
  EXPECT_LT(variance_x_px2(zncc, dim, 16384, 2.0), 0.5 * variance_x_px2(zncc, dim, 16384, 0.0));
}

// An engine with a bias, or a coarser fit, owns up to it.
TEST(ShiftCovariance, NamesTheErrorOfEngineAndFit) {
  const auto variance = [](PeakFit fit, Engine engine) {
    Peak peak = wide_peak();
    peak.fit = fit;
    const ShiftError error =
        shift_error(peak, 1.0, bright(), bright(), 16384.0, {.engine = engine});
    EXPECT_LE(error.model_sigma_x_px, std::sqrt(error.cov.xx_px2));
    EXPECT_GT(error.model_sigma_y_px, 0.0);
    return error.cov.xx_px2;
  };
  EXPECT_GT(variance(PeakFit::gaussian2d, Engine::zncc), variance(PeakFit::sinc, Engine::zncc));
  EXPECT_GT(variance(PeakFit::sinc, Engine::cross), variance(PeakFit::sinc, Engine::zncc));
  EXPECT_GT(variance(PeakFit::sinc, Engine::phase), variance(PeakFit::sinc, Engine::zncc));
  EXPECT_EQ(variance(PeakFit::sinc, Engine::direct), variance(PeakFit::sinc, Engine::zncc));
}

}  // namespace
}  // namespace lsv
