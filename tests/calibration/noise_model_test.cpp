// SPDX-License-Identifier: BSD-3-Clause
// Laws of the noise prediction, and figures of the accuracy report that it was not made from. That
// it agrees with tracked frames: tests/lsv/noise_prediction_test.cpp.
#include "calibration/noise_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "calibration/noise_choice.h"
#include "calibration/speckle_geometry.h"

namespace lsv {
namespace {

/// Condition B of docs/accuracy.md.
NoiseConditions usual() {
  NoiseConditions out;
  out.width_px = out.height_px = 128;
  out.speckle_px = 4.0;
  out.mean_signal_counts = 60.0;
  out.dark_counts = 3.0;
  out.noise_sd_counts = 0.5;
  return out;
}

/// Nothing clipped and nothing rounded: noise alone.
NoiseConditions noisy() {
  NoiseConditions out = usual();
  out.bit_depth = 16;
  out.mean_signal_counts = 3000.0;
  out.noise_sd_counts = 100.0;
  return out;
}

double sigma_x(const NoiseConditions& c) { return predict_noise(c).sigma_x_px; }

TEST(NoiseModel, FallsWithTheRootOfThePixels) {
  NoiseConditions c = noisy();
  const NoisePrediction small = predict_noise(c);
  c.width_px = c.height_px = 256;
  const NoisePrediction large = predict_noise(c);
  EXPECT_NEAR(small.x.noise_px / large.x.noise_px, std::sqrt(large.used_px / small.used_px), 0.01);
  EXPECT_NEAR(small.sigma_x_px / large.sigma_x_px, 248.0 / 120.0, 0.05);
  c.height_px = 128;
  EXPECT_NEAR(sigma_x(c) / large.sigma_x_px, std::sqrt(248.0 / 120.0), 0.03);
}

TEST(NoiseModel, RisesLinearlyWithNoiseAndFallsWithLight) {
  NoiseConditions c = noisy();
  const double one = predict_noise(c).x.noise_px;
  c.noise_sd_counts *= 2.0;
  EXPECT_NEAR(predict_noise(c).x.noise_px / one, 2.0, 0.02);
  c.mean_signal_counts *= 2.0;
  EXPECT_NEAR(predict_noise(c).x.noise_px / one, 1.0, 0.02);
}

TEST(NoiseModel, ShotNoiseGoesWithTheRootOfTheElectrons) {
  NoiseConditions c = noisy();
  c.noise_sd_counts = 0.0;
  c.electrons_per_count = 0.2;
  const double few = predict_noise(c).x.noise_px;
  c.electrons_per_count = 0.8;
  EXPECT_NEAR(few / predict_noise(c).x.noise_px, 2.0, 0.02);
  // Twice as much light in the same electrons per count: the root of two better.
  const double dim = predict_noise(c).x.noise_px;
  c.mean_signal_counts *= 2.0;
  EXPECT_NEAR(dim / predict_noise(c).x.noise_px, std::sqrt(2.0), 0.02);
}

TEST(NoiseModel, RisesAsThePatternChanges) {
  for (const double mean_counts : {20.0, 95.0}) {
    NoiseConditions c = usual();
    c.mean_signal_counts = mean_counts;
    double before_px = 0.0;
    for (const double lost : {0.0, 1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 0.01, 0.1, 0.3, 0.5}) {
      c.rho = 1.0 - lost;
      const double sigma_px = sigma_x(c);
      EXPECT_GT(sigma_px, before_px) << mean_counts << " counts, rho " << c.rho;
      before_px = sigma_px;
    }
  }
}

TEST(NoiseModel, BlurHurtsMoreAlongTheMotion) {
  NoiseConditions c = usual();
  c.mean_signal_counts = 20.0;
  EXPECT_NEAR(predict_noise(c).sigma_x_px / predict_noise(c).sigma_y_px, 1.0, 0.03);
  double before_x_px = 0.0;
  double before_y_px = 0.0;
  for (const double blur_px : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
    c.blur_px = blur_px;
    const NoisePrediction p = predict_noise(c);
    EXPECT_GT(p.sigma_x_px, before_x_px) << blur_px;
    EXPECT_GT(p.sigma_y_px, before_y_px) << blur_px;
    before_x_px = p.sigma_x_px;
    before_y_px = p.sigma_y_px;
  }
  EXPECT_GT(before_x_px, 1.5 * before_y_px);
}

TEST(NoiseModel, AShiftTakesPixelsAway) {
  NoiseConditions c = usual();
  const double still_px = sigma_x(c);
  c.shift_px = 32.0;
  const NoisePrediction moved = predict_noise(c);
  EXPECT_GT(moved.sigma_x_px, 1.1 * still_px);
  c.shift_px = -32.0;
  EXPECT_EQ(sigma_x(c), moved.sigma_x_px);
}

TEST(NoiseModel, WithoutLightNothingIsKnown) {
  NoiseConditions c = usual();
  c.mean_signal_counts = 0.0;
  const NoisePrediction p = predict_noise(c);
  EXPECT_TRUE(std::isnan(p.sigma_x_px));
  EXPECT_EQ(p.range, NoiseRange::no_light);
  EXPECT_TRUE(std::isnan(predict_tracking_noise(c).step_x_px));
}

TEST(NoiseModel, NothingIsExtrapolated) {
  using Change = void (*)(NoiseConditions&);
  const std::pair<Change, NoiseRange> cases[] = {
      {[](NoiseConditions& c) { c.speckle_px = 2.4; }, NoiseRange::speckle},
      {[](NoiseConditions& c) { c.speckle_px = 9.1; }, NoiseRange::speckle},
      {[](NoiseConditions& c) { c.speckle_px = kUnknown; }, NoiseRange::not_a_number},
      {[](NoiseConditions& c) { c.blur_px = 6.1; }, NoiseRange::blur},
      {[](NoiseConditions& c) { c.blur_px = -1.0; }, NoiseRange::not_a_number},
      {[](NoiseConditions& c) { c.width_px = 47; }, NoiseRange::window},
      {[](NoiseConditions& c) { c.height_px = 513; }, NoiseRange::window},
      {[](NoiseConditions& c) { c.mean_signal_counts = 102.0; }, NoiseRange::saturation},
      {[](NoiseConditions& c) { c.mean_signal_counts = 2.0; }, NoiseRange::no_light},
      {[](NoiseConditions& c) { c.rho = 0.49; }, NoiseRange::boiling},
      {[](NoiseConditions& c) { c.rho = 1.01; }, NoiseRange::not_a_number},
      {[](NoiseConditions& c) { c.shift_px = 65.0; }, NoiseRange::shift},
      {[](NoiseConditions& c) { c.noise_sd_counts = 25.0; }, NoiseRange::low_contrast},
      {[](NoiseConditions& c) { c.noise_sd_counts = -1.0; }, NoiseRange::not_a_number},
      {[](NoiseConditions& c) { c.electrons_per_count = 0.0; }, NoiseRange::not_a_number},
      {[](NoiseConditions& c) { c.bit_depth = 7; }, NoiseRange::not_a_number},
      {[](NoiseConditions& c) { c.width_px = c.height_px = 48, c.speckle_px = 9.0; },
       NoiseRange::few_speckles},
      {[](NoiseConditions& c) {
         c.width_px = c.height_px = 48, c.speckle_px = 2.5, c.mean_signal_counts = 100.0;
       },
       NoiseRange::few_pixels},
  };
  int i = 0;
  for (const auto& [change, range] : cases) {
    NoiseConditions c = usual();
    change(c);
    const NoisePrediction p = predict_noise(c);
    EXPECT_EQ(p.range, range) << "case " << i;
    EXPECT_TRUE(std::isnan(p.sigma_x_px) && std::isnan(p.sigma_y_px)) << "case " << i;
    EXPECT_FALSE(advice(p.range).empty());
    ++i;
  }
}

TEST(NoiseModel, IsSmoothAcrossTheNodesOfItsTable) {
  using Change = void (*)(NoiseConditions&, double);
  const std::pair<Change, double> nodes[] = {
      {[](NoiseConditions& c, double v) { c.speckle_px = v; }, 3.0},
      {[](NoiseConditions& c, double v) { c.speckle_px = v; }, 6.0},
      {[](NoiseConditions& c, double v) { c.blur_px = v; }, 2.0},
      {[](NoiseConditions& c, double v) { c.blur_px = v; }, 4.0},
      {[](NoiseConditions& c, double v) { c.mean_signal_counts = 252.0 * v; }, 0.2},
      {[](NoiseConditions& c, double v) { c.mean_signal_counts = 252.0 * v; }, 0.35}};
  for (const auto& [change, node] : nodes) {
    NoiseConditions below = usual();
    NoiseConditions above = usual();
    change(below, node * (1.0 - 1e-6));
    change(above, node * (1.0 + 1e-6));
    EXPECT_NEAR(sigma_x(below) / sigma_x(above), 1.0, 1e-4) << node;
  }
}

// Measured by bench/accuracy with 500 pairs each: docs/accuracy.md, `precise`, shifts of +-3 px.
TEST(NoiseModel, AgreesWithTheAccuracyReport) {
  struct Figure {
    double speckle_px, mean_counts, noise_sd_counts, full_well_e, rho, rmse_mpx;
  };
  const Figure figures[] = {
      {3, 60, 0.5, 0, 1, 0.243},    {4, 60, 0.5, 0, 1, 0.304},    {6, 60, 0.5, 0, 1, 0.442},
      {3, 60, 0.5, 1e4, 1, 0.643},  {4, 60, 0.5, 1e4, 1, 0.785},  {6, 60, 0.5, 1e4, 1, 1.15},
      {3, 12, 2.0, 0, 1, 2.88},     {4, 12, 2.0, 0, 1, 3.79},     {6, 12, 2.0, 0, 1, 5.70},
      {3, 60, 0.5, 0, 0.999, 1.50}, {4, 60, 0.5, 0, 0.999, 2.44}, {6, 60, 0.5, 0, 0.999, 5.21},
      {3, 60, 0.5, 0, 0.99, 4.37},  {4, 60, 0.5, 0, 0.99, 7.64},  {6, 60, 0.5, 0, 0.99, 16.6},
      {3, 60, 0.5, 0, 0.9, 14.4},   {4, 60, 0.5, 0, 0.9, 25.6},   {6, 60, 0.5, 0, 0.9, 55.5},
      {3, 60, 0.5, 0, 0.7, 29.2},   {4, 60, 0.5, 0, 0.7, 52.2},   {6, 60, 0.5, 0, 0.7, 113.0}};
  for (const Figure& f : figures) {
    NoiseConditions c = usual();
    c.speckle_px = f.speckle_px;
    c.mean_signal_counts = f.mean_counts;
    c.noise_sd_counts = f.noise_sd_counts;
    if (f.full_well_e > 0.0) c.electrons_per_count = f.full_well_e / 255.0;
    c.rho = f.rho;
    c.shift_px = 1.5;
    const double predicted_mpx = 1e3 * sigma_x(c);
    std::printf("speckle %g px, mean %g, noise %g, rho %g: predicted %.3f, measured %.3f mpx\n",
                f.speckle_px, f.mean_counts, f.noise_sd_counts, f.rho, predicted_mpx, f.rmse_mpx);
    EXPECT_NEAR(predicted_mpx / f.rmse_mpx, 1.0, 0.15);
  }
}

// Ratios are known better than figures: the law of boiling (D70 over D90 of the accuracy report),
// and what clipping does to it (simulated at 3 px, 100 and 20 counts, 640 pairs each).
TEST(NoiseModel, BoilingFollowsItsLaw) {
  for (const double speckle_px : {3.0, 4.0, 6.0}) {
    NoiseConditions c = usual();
    c.speckle_px = speckle_px;
    c.rho = 0.9;
    const double at_90_px = sigma_x(c);
    c.rho = 0.7;
    EXPECT_NEAR(sigma_x(c) / at_90_px, 2.035, 0.05) << speckle_px;
  }
  NoiseConditions c = usual();
  c.speckle_px = 3.0;
  c.rho = 0.9;
  c.mean_signal_counts = 20.0;
  const double unclipped_px = sigma_x(c);
  c.mean_signal_counts = 100.0;
  EXPECT_NEAR(sigma_x(c) / unclipped_px, 0.927, 0.04);
}

// The figures of the source: 0.1 px is 0.7 mm/s (eq. 6.4), and the range at 1000 frames a second.
TEST(NoiseModel, UnitsOfTheSource) {
  const SensorScale scale{.sc_ratio = 2.0, .pixel_pitch_m = 14e-6, .rate_hz = 1000.0};
  EXPECT_NEAR(velocity_sigma_m_s(scale, 0.1), 0.700e-3, 1e-12);
  EXPECT_NEAR(shift_px_per_frame(scale, 80e-3), 11.43, 0.005);
}

TEST(TrackingNoise, AKeyframeLastsHalfAWindowWhereNoiseRules) {
  NoiseConditions c = noisy();
  c.shift_px = 2.0;
  const TrackingNoise t = predict_tracking_noise(c);
  EXPECT_NEAR(t.frames_per_keyframe, 30, 4);
  // The keyframe's own noise cancels: no worse than a pair, but for the pixels that leave the view.
  EXPECT_GT(t.step_x_px, sigma_x(c));
  EXPECT_LT(t.step_x_px, 1.35 * sigma_x(c));
  EXPECT_LT(t.drift_x_px2, 0.1 * t.step_x_px * t.step_x_px);
}

TEST(TrackingNoise, AtRestNothingDrifts) {
  const TrackingNoise t = predict_tracking_noise(usual());
  EXPECT_EQ(t.frames_per_keyframe, kFramesPerKeyframeLimit);
  EXPECT_LT(std::sqrt(t.drift_x_px2), 0.02 * t.step_x_px);
}

TEST(TrackingNoise, AChangingPatternDriftsAsFastAsItSteps) {
  NoiseConditions c = usual();
  c.rho = 0.9;
  c.shift_px = 3.0;
  const TrackingNoise t = predict_tracking_noise(c);
  EXPECT_EQ(t.frames_per_keyframe, 1);
  EXPECT_DOUBLE_EQ(t.drift_x_px2, t.step_x_px * t.step_x_px);
}

}  // namespace
}  // namespace lsv
