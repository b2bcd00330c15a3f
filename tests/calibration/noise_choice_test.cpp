// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/noise_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lsv {
namespace {

/// The sensor of the Masuku thesis with 80 mm/s to measure.
ChoiceQuestion question() {
  ChoiceQuestion out;
  out.known.width_px = out.known.height_px = 128;
  out.known.speckle_px = 4.0;
  out.known.mean_signal_counts = 60.0;
  out.known.dark_counts = 3.0;
  out.known.noise_sd_counts = 0.5;
  out.known.electrons_per_count = 40.0;
  out.scale = {.sc_ratio = 2.0, .pixel_pitch_m = 14e-6, .rate_hz = 1000.0};
  out.exposure_s = 200e-6;
  out.speed_m_s = 80e-3;
  return out;
}

void expect_kept(const ChoiceQuestion& q, const Choice& c) {
  EXPECT_LE(c.shift_px, 0.25 * c.window_px * (1.0 + 1e-6));
  EXPECT_LE(c.blur_px, q.known.speckle_px * (1.0 + 1e-6));
  EXPECT_LE(c.exposure_s * c.rate_hz, 1.0 + 1e-6);
  EXPECT_GE(c.zncc_sigmas, 12.0);
  EXPECT_GE(c.rate_hz, q.update_hz * (1.0 - 1e-6));
  EXPECT_NEAR(c.shift_px, q.speed_m_s * 2.0 / 14e-6 / c.rate_hz, 1e-9);
  EXPECT_NEAR(c.mean_signal_counts, 60.0 * c.exposure_s / 200e-6, 1e-9);
}

TEST(NoiseChoice, NothingThatWasTriedIsMuchBetter) {
  const ChoiceQuestion q = question();
  const Recommendation r = recommend(q);
  ASSERT_TRUE(r.best);
  expect_kept(q, *r.best);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> log_rate(std::log(100.0), std::log(1000.0));
  std::uniform_real_distribution<double> log_exposure(std::log(1e-5), std::log(1e-2));
  int tried = 0;
  for (int i = 0; i < 3000; ++i) {
    const int window_px = q.windows_px[random() % q.windows_px.size()];
    const Attempt attempt =
        evaluate(q, window_px, std::exp(log_rate(random)), std::exp(log_exposure(random)));
    if (!attempt.choice) continue;
    ++tried;
    expect_kept(q, *attempt.choice);
    EXPECT_GT(attempt.choice->update_sigma_m_s, 0.9 * r.best->update_sigma_m_s);
  }
  EXPECT_GT(tried, 300);
}

TEST(NoiseChoice, TheCameraLimitsTheRateOfEachWindow) {
  ChoiceQuestion q = question();
  q.camera_rates = {{64, 2000.0}, {128, 400.0}};
  const Recommendation r = recommend(q);
  for (const WindowChoice& window : r.windows) {
    if (window.window_px > 128) {
      EXPECT_EQ(window.limit, ChoiceLimit::camera) << window.window_px;
    } else if (window.window_px > 64) {
      // A quarter of 96 px at 400 Hz is 67 mm/s.
      EXPECT_EQ(window.limit, window.window_px == 96 ? ChoiceLimit::speed : ChoiceLimit::none);
      EXPECT_TRUE(!window.best || window.best->rate_hz <= 400.0);
    } else {
      ASSERT_TRUE(window.best);
      EXPECT_GE(window.best->rate_hz, 80e-3 * 2.0 / 14e-6 / 16.0 * (1.0 - 1e-6));
    }
  }
}

TEST(NoiseChoice, AProcessorThatIsTooSlowLimitsTheRate) {
  ChoiceQuestion q = question();
  q.push_s_per_px = 1.0 / (128.0 * 128.0) / 2000.0;  // 128 px: at most 1000 Hz
  const Recommendation r = recommend(q);
  ASSERT_TRUE(r.best);
  for (const WindowChoice& window : r.windows) {
    EXPECT_TRUE(!window.best || window.best->push_load_ratio <= 0.5 * (1.0 + 1e-6));
  }
  // It takes sixteen times as long as 128 px: 62.5 Hz, under the update rate.
  ASSERT_EQ(r.windows.back().window_px, 512);
  EXPECT_EQ(r.windows.back().limit, ChoiceLimit::processor);
}

TEST(NoiseChoice, ASpeedOutOfReachIsSaid) {
  ChoiceQuestion q = question();
  q.speed_m_s = 2.0;
  const Recommendation r = recommend(q);
  EXPECT_FALSE(r.best);
  for (const WindowChoice& window : r.windows)
    EXPECT_EQ(window.limit, ChoiceLimit::speed) << window.window_px;
}

TEST(NoiseChoice, DarknessIsSaid) {
  ChoiceQuestion q = question();
  q.known.mean_signal_counts = 0.0;
  const Recommendation r = recommend(q);
  EXPECT_FALSE(r.best);
  EXPECT_EQ(r.windows.back().limit, ChoiceLimit::noise);
}

// A velocity wanted more often is known less well, and a boiling pattern makes everything worse.
TEST(NoiseChoice, Trends) {
  ChoiceQuestion q = question();
  const double usual_m_s = recommend(q).best->update_sigma_m_s;
  q.update_hz = 400.0;
  EXPECT_GT(recommend(q).best->update_sigma_m_s, 2.0 * usual_m_s);
  q = question();
  q.known.rho = 0.99;
  EXPECT_GT(recommend(q).best->update_sigma_m_s, 3.0 * usual_m_s);
  q = question();
  q.known.noise_sd_counts = 5.0;
  EXPECT_GT(recommend(q).best->update_sigma_m_s, usual_m_s);
}

TEST(NoiseChoice, SaysWhatStandsInTheWay) {
  const ChoiceQuestion q = question();
  EXPECT_EQ(evaluate(q, 128, 2000.0, 1e-4).limit, ChoiceLimit::camera);
  EXPECT_EQ(evaluate(q, 128, 50.0, 1e-4).limit, ChoiceLimit::update);
  EXPECT_EQ(evaluate(q, 128, 300.0, 1e-4).limit, ChoiceLimit::speed);
  EXPECT_EQ(evaluate(q, 128, 800.0, 1.3e-3).limit, ChoiceLimit::exposure);
  EXPECT_EQ(evaluate(q, 128, 800.0, 4e-4).limit, ChoiceLimit::blur);
  const Attempt dark = evaluate(q, 128, 800.0, 2e-6);
  EXPECT_EQ(dark.limit, ChoiceLimit::noise);
  EXPECT_EQ(dark.range, NoiseRange::no_light);
  EXPECT_TRUE(evaluate(q, 128, 800.0, 2e-4).choice);
}

}  // namespace
}  // namespace lsv
