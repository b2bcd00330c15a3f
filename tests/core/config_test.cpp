// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/config.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/support/calibration.h"

namespace lsv {
namespace {

TEST(Validate, AcceptsTheDefaultsWithACalibration) {
  EXPECT_TRUE(validate(test::bridget_config()));
}

TEST(Validate, ACalibrationIsNeverTheIdentityByDefault) { EXPECT_FALSE(validate(TrackConfig{})); }

TEST(Validate, NamesTheSettingThatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const struct {
    const char* name;
    std::function<void(TrackConfig&)> spoil;
  } cases[] = {
      {"max_shift_px", [](TrackConfig& c) { c.correlation.max_shift_px = 1; }},
      {"min_zncc", [](TrackConfig& c) { c.gate.min_zncc = 1.5; }},
      {"min_zncc", [nan](TrackConfig& c) { c.gate.min_zncc = nan; }},
      {"min_zncc_sigmas", [](TrackConfig& c) { c.gate.min_zncc_sigmas = -1.0; }},
      {"min_q", [](TrackConfig& c) { c.gate.min_q = -1.0; }},
      {"min_peak_ratio", [inf](TrackConfig& c) { c.gate.min_peak_ratio = inf; }},
      {"min_signal_fraction", [](TrackConfig& c) { c.gate.min_signal_fraction = 2.0; }},
      {"max_saturated_fraction", [](TrackConfig& c) { c.gate.max_saturated_fraction = -0.1; }},
      {"min_contrast_to_noise", [nan](TrackConfig& c) { c.gate.min_contrast_to_noise = nan; }},
      {"pixel_pitch_x_m", [](TrackConfig& c) { c.calibration.pixel_pitch_x_m = 0.0; }},
      {"pixel_pitch_y_m", [](TrackConfig& c) { c.calibration.pixel_pitch_y_m = -14e-6; }},
      {"sc_x_ratio", [inf](TrackConfig& c) { c.calibration.sc_x_ratio = inf; }},
      {"sc_y_ratio", [nan](TrackConfig& c) { c.calibration.sc_y_ratio = nan; }},
      {"noise_mean_counts", [](TrackConfig& c) { c.calibration.noise_mean_counts = -3.0; }},
      {"noise_sd_counts", [](TrackConfig& c) { c.calibration.noise_sd_counts = -0.5; }},
  };
  for (const auto& [name, spoil] : cases) {
    TrackConfig config = test::bridget_config();
    spoil(config);
    const Result<void> result = validate(config);
    ASSERT_FALSE(result) << name;
    EXPECT_EQ(result.error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(result.error().message.find(std::string(name) + " is "), 0U)
        << result.error().message;
  }
}

TEST(Words, RoundTrip) {
  for (const Engine engine : {Engine::zncc, Engine::cross, Engine::phase, Engine::direct})
    EXPECT_EQ(engine_from(word(engine)), engine);
  for (const PeakFit fit :
       {PeakFit::sinc, PeakFit::gaussian2d, PeakFit::gaussian3, PeakFit::parabola3})
    EXPECT_EQ(peak_fit_from(word(fit)), fit);
  EXPECT_FALSE(engine_from("fft"));
  EXPECT_FALSE(peak_fit_from(""));
}

}  // namespace
}  // namespace lsv
