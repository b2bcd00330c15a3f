// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/camera_characterisation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <numeric>

#include "calibration/calibration_io.h"
#include "calibration/camera_warnings.h"
#include "calibration/sha256.h"
#include "sim/flat_field.h"
#include "tests/support/calibration.h"

namespace lsv {
namespace {

constexpr double kFullScale_counts = 4095.0;
constexpr double kFullWell_e = 10000.0;
constexpr double kK_counts_per_e = kFullScale_counts / kFullWell_e;
const std::vector<double> kLevels_counts = {300.0, 900.0, 1500.0, 2100.0, 2700.0, 3900.0};

sim::SpeckleConfig sensor(std::uint64_t seed) {
  sim::SpeckleConfig out{.width_px = 72,
                         .height_px = 64,
                         .bit_depth = 12,
                         .noise_mean_counts = 60.0,
                         .noise_sd_counts = 2.5,
                         .full_well_electrons = kFullWell_e,
                         .seed = seed};
  out.sensor.dsnu_counts = 4.0;
  out.sensor.prnu_ratio = 0.015;
  out.sensor.hot_pixels = 12;
  out.sensor.dead_pixels = 9;
  return out;
}

LightSequence record(sim::SpeckleConfig config, double level_counts, int frames,
                     double gradient_ratio = 0.0) {
  config.mean_signal_counts = level_counts;
  sim::FlatFieldCamera camera = sim::FlatFieldCamera::create(config, gradient_ratio).value();
  LightSequence out{.name = "light" + std::to_string(std::lround(level_counts)),
                    .statistics = PixelStatistics::create(sim::frame_format(config)).value(),
                    .exposure_us = level_counts};
  Frame frame;
  for (int k = 0; k < frames; ++k) {
    EXPECT_TRUE(camera.render(k, frame));
    EXPECT_TRUE(out.statistics.add(frame.view()));
  }
  return out;
}

std::vector<LightSequence> record_all(const sim::SpeckleConfig& config,
                                      const std::vector<double>& levels_counts, int frames,
                                      double gradient_ratio = 0.0) {
  std::vector<LightSequence> out;
  for (const double level : levels_counts)
    out.push_back(record(config, level, frames, gradient_ratio));
  return out;
}

/// What is wrong with the defects found, as a number of pixels.
struct DefectErrors {
  int missed = 0;
  int invented = 0;
};
DefectErrors defect_errors(const sim::SensorPattern& truth, const SensorMaps& maps) {
  DefectErrors out;
  for (std::size_t i = 0; i < maps.defect.size(); ++i) {
    const bool bad = truth.state[i] != sim::PixelState::good;
    if (bad && maps.defect[i] == 0) ++out.missed;
    if (!bad && maps.defect[i] != 0) ++out.invented;
  }
  return out;
}

/// Errors of one figure over many sensors, each in its own sigmas.
struct Errors {
  std::vector<double> sigmas{};
  void add(const Measured& m, double truth) { sigmas.push_back((m.value - truth) / m.sigma); }
  double rms() const {
    double sum = 0.0;
    for (const double e : sigmas) sum += e * e;
    return std::sqrt(sum / static_cast<double>(sigmas.size()));
  }
  double mean() const {
    return std::accumulate(sigmas.begin(), sigmas.end(), 0.0) / static_cast<double>(sigmas.size());
  }
  double within(double limit) const {
    const auto count =
        std::ranges::count_if(sigmas, [limit](double e) { return std::abs(e) <= limit; });
    return static_cast<double>(count) / static_cast<double>(sigmas.size());
  }
};

/// A kind of camera and of light, and what limits the figures.
struct Condition {
  const char* name;
  sim::SpeckleConfig camera;
  std::vector<double> levels_counts;
  int frames;
  double gradient_ratio;
  enum class Limit {
    chance,   // sigmas are neither too small nor too large
    cut_off,  // of mu_dark an upper bound: pixels are cut off at 0
    rounding  // the same error in every sensor
  } limit;
};

sim::SpeckleConfig eight_bit(double noise_mean_counts, double noise_sd_counts, double dsnu_counts,
                             double prnu_ratio) {
  sim::SpeckleConfig out = sensor(0);
  out.bit_depth = 8;
  out.noise_mean_counts = noise_mean_counts;
  out.noise_sd_counts = noise_sd_counts;
  out.sensor.dsnu_counts = dsnu_counts;
  out.sensor.prnu_ratio = prnu_ratio;
  return out;
}

std::vector<Condition> conditions() {
  using enum Condition::Limit;
  const std::vector<double> levels_8_bit = {40.0, 80.0, 120.0, 160.0, 200.0};
  sim::SpeckleConfig few_electrons = eight_bit(20.0, 1.5, 1.0, 0.01);
  few_electrons.full_well_electrons = 400.0;
  return {{"12 bit", sensor(0), kLevels_counts, 24, 0.0, chance},
          {"12 bit, light falling by 20 %", sensor(0), kLevels_counts, 24, 0.2, chance},
          {"12 bit, 3 frames", sensor(0), kLevels_counts, 3, 0.0, chance},
          {"full well of 400 e-, light falling by 10 %",
           few_electrons,
           {20.0, 50.0, 90.0, 130.0, 170.0},
           20,
           0.1,
           chance},
          {"8 bit, DSNU of a third of the dark level", eight_bit(15.0, 0.5, 5.0, 0.02),
           levels_8_bit, 20, 0.0, cut_off},
          {"8 bit, all pixels at one level, quiet", eight_bit(15.0, 0.5, 0.0, 0.0), levels_8_bit,
           20, 0.0, rounding},
          {"8 bit, noise of 0.2 counts", eight_bit(15.3, 0.2, 1.0, 0.01), levels_8_bit, 20, 0.0,
           rounding}};
}

/// Figure by figure over some sensors of one kind; DSNU also against that of the very pixels.
struct Repetition {
  std::map<std::string, Errors> errors;
  Errors dsnu_of_these_pixels;
};

Repetition repeat(const Condition& condition) {
  constexpr int kSensors = 12;
  Repetition out;
  for (int n = 0; n < kSensors; ++n) {
    sim::SpeckleConfig config = condition.camera;
    config.seed = 100 + static_cast<std::uint64_t>(n);
    const Result<CameraCharacterisation> result = characterise_camera(
        record(config, 0.0, condition.frames),
        record_all(config, condition.levels_counts, condition.frames, condition.gradient_ratio));
    EXPECT_TRUE(result) << result.error().message;
    const CameraCharacterisation& c = result.value();
    const sim::SensorPattern truth = sim::FlatFieldCamera::create(config).value().pattern();
    const DefectErrors defects = defect_errors(truth, c.maps);
    EXPECT_EQ(defects.missed, 0) << condition.name << ", sensor " << n;
    EXPECT_EQ(defects.invented, 0) << condition.name << ", sensor " << n;
    EXPECT_EQ(c.defects.counts.hot, 12U);
    EXPECT_EQ(c.defects.counts.dead, 9U);
    EXPECT_NEAR(c.light_range_ratio, condition.gradient_ratio, 0.03);
    double offset_counts = 0.0;
    double offset2_counts2 = 0.0;
    double good = 0.0;
    for (std::size_t i = 0; i < truth.state.size(); ++i) {
      if (truth.state[i] != sim::PixelState::good) continue;
      const double offset = truth.offset_counts.empty() ? 0.0 : truth.offset_counts[i];
      offset_counts += offset;
      offset2_counts2 += offset * offset;
      good += 1.0;
    }
    offset_counts /= good;
    const double k = full_scale_counts(config.bit_depth) / *config.full_well_electrons;
    out.errors["K"].add(c.transfer.k_counts_per_e, k);
    out.errors["mu_dark"].add(c.mu_dark_counts, config.noise_mean_counts + offset_counts);
    out.errors["sigma_d"].add(c.dark_noise_e, config.noise_sd_counts / k);
    out.errors["DSNU"].add(c.dsnu_e, config.sensor.dsnu_counts / k);
    out.errors["PRNU"].add(c.prnu_ratio, config.sensor.prnu_ratio);
    out.dsnu_of_these_pixels.add(c.dsnu_counts,
                                 std::sqrt(offset2_counts2 / good - offset_counts * offset_counts));
    if (n > 0) continue;
    std::printf(
        "%s: K %.5g +- %.2g (true %.5g) counts/e-, sigma_d %.4g +- %.2g (%.4g) e-, DSNU %.4g +- "
        "%.2g (%.4g) e-, PRNU %.3f +- %.2g (%.1f) %%\n",
        condition.name, c.transfer.k_counts_per_e.value, c.transfer.k_counts_per_e.sigma, k,
        c.dark_noise_e.value, c.dark_noise_e.sigma, config.noise_sd_counts / k, c.dsnu_e.value,
        c.dsnu_e.sigma, config.sensor.dsnu_counts / k, 100.0 * c.prnu_ratio.value,
        100.0 * c.prnu_ratio.sigma, 100.0 * config.sensor.prnu_ratio);
  }
  return out;
}

// The claim: K, mu_dark, sigma_d, DSNU and PRNU within 2 sigma in 95 % of the cases, sigmas of the
// right size, and just the defects that are there, for cameras of all kinds.
TEST(CameraCharacterisation, RecoversKnownCamerasWithHonestSigmas) {
  for (const Condition& condition : conditions()) {
    SCOPED_TRACE(condition.name);
    const Repetition repetition = repeat(condition);
    // A figure that may be 0 has its truth at exactly 2 sigma, but for the last digit.
    constexpr double kTwoSigmas = 2.001;
    for (const auto& [name, e] : repetition.errors) {
      std::printf("  %-8s error / sigma rms %.2f, within 2 sigma %.0f %%\n", name.c_str(), e.rms(),
                  100.0 * e.within(kTwoSigmas));
      EXPECT_GE(e.within(kTwoSigmas), 0.83) << name;
      EXPECT_EQ(e.within(3.5), 1.0) << name;
      EXPECT_LT(e.rms(), 1.5) << name;
      if (condition.limit == Condition::Limit::chance) {
        EXPECT_GT(e.rms(), 0.6) << name;
      }
    }
    if (condition.limit != Condition::Limit::chance) continue;
    // Against the very pixels, not the population: no bias.
    const Errors& these = repetition.dsnu_of_these_pixels;
    std::printf("  DSNU against that of the same pixels: error / sigma mean %+.2f, rms %.2f\n",
                these.mean(), these.rms());
    EXPECT_LT(std::abs(these.mean()), 0.25);
  }
}

TEST(CameraCharacterisation, MapsAreThoseOfTheSensorUnderUnevenLight) {
  const sim::SpeckleConfig config = sensor(31);
  constexpr int kFrames = 40;
  const CameraCharacterisation c =
      characterise_camera(record(config, 0.0, kFrames),
                          record_all(config, kLevels_counts, kFrames, 0.2))
          .value();
  const sim::SensorPattern truth = sim::FlatFieldCamera::create(config).value().pattern();
  double offset2 = 0.0;
  double gain2 = 0.0;
  double good = 0.0;
  for (std::size_t i = 0; i < truth.state.size(); ++i) {
    ASSERT_GT(c.maps.gain_ratio[i], 0.0F);
    if (truth.state[i] != sim::PixelState::good) continue;
    offset2 += std::pow(c.maps.offset_counts[i] - 60.0 - truth.offset_counts[i], 2.0);
    gain2 += std::pow(c.maps.gain_ratio[i] - truth.gain_ratio[i], 2.0);
    good += 1.0;
  }
  const double offset_error_counts = std::sqrt(offset2 / good);
  const double gain_error_ratio = std::sqrt(gain2 / good);
  std::printf("error of the maps, rms: offset %.3f counts (noise %.3f), gain %.4f (noise %.4f)\n",
              offset_error_counts, c.offset_map_noise_counts, gain_error_ratio,
              c.gain_map_noise_ratio);
  EXPECT_NEAR(offset_error_counts, c.offset_map_noise_counts, 0.05 * c.offset_map_noise_counts);
  // The smooth light takes a tenth of the pattern along.
  EXPECT_LT(gain_error_ratio, std::hypot(c.gain_map_noise_ratio, 0.1 * 0.015));
  EXPECT_EQ(c.flats[c.gain_level].name, "light2700");
  EXPECT_EQ(c.flats[c.prnu_level].name, "light1500");
}

/// Variance over time of counts cut off at full scale, on average over pixels of such a spread.
double clipped_variance_counts2(double signal_counts) {
  const double sd = std::sqrt(kK_counts_per_e * signal_counts + 2.5 * 2.5);
  const double spread = std::hypot(4.0, 0.015 * signal_counts);
  double out = 0.0;
  double weights = 0.0;
  for (double pixel = -4.0; pixel <= 4.0; pixel += 0.05) {
    const double h = (kFullScale_counts - 60.0 - signal_counts - pixel * spread) / sd;
    const double density = std::exp(-0.5 * h * h) / std::sqrt(2.0 * std::numbers::pi);
    const double below = 0.5 * std::erfc(-h / std::numbers::sqrt2);
    const double mean = -density + h * (1.0 - below);
    const double square = below - h * density + h * h * (1.0 - below);
    const double weight = std::exp(-0.5 * pixel * pixel);
    out += weight * sd * sd * (square - mean * mean);
    weights += weight;
  }
  return out / weights;
}

// EMVA 1288 puts saturation where the variance is greatest.
TEST(CameraCharacterisation, SaturationLiesWhereTheNoiseIsGreatest) {
  double true_signal = 3000.0;
  for (double signal = 3000.0; signal < 4100.0; signal += 1.0) {
    if (clipped_variance_counts2(signal) > clipped_variance_counts2(true_signal))
      true_signal = signal;
  }
  const sim::SpeckleConfig config = sensor(32);
  std::vector<double> levels = {500.0, 1000.0, 1800.0};
  for (double level = 3500.0; level < 4400.0; level += 100.0) levels.push_back(level);
  const CameraCharacterisation c =
      characterise_camera(record(config, 0.0, 20), record_all(config, levels, 20)).value();
  std::printf("saturation %.0f +- %.0f counts, %.0f +- %.0f e-, noise greatest at %.0f counts\n",
              c.saturation_counts.value, c.saturation_counts.sigma, c.saturation_e.value,
              c.saturation_e.sigma, 60.0 + true_signal);
  EXPECT_TRUE(c.saturation_reached);
  EXPECT_NEAR(c.saturation_counts.value, 60.0 + true_signal, 100.0);
  EXPECT_NEAR(c.saturation_e.value, (c.saturation_counts.value - 60.0) / kK_counts_per_e,
              2.0 * c.saturation_e.sigma);
  EXPECT_NEAR(c.snr_max_ratio.value, std::sqrt(c.saturation_e.value), 1e-9);
  EXPECT_NEAR(c.dynamic_range_ratio.value, c.saturation_e.value / (2.5 / kK_counts_per_e + 0.5),
              0.02 * c.dynamic_range_ratio.value);
}

TEST(CameraCharacterisation, WithoutSaturationThereIsALowerBound) {
  const sim::SpeckleConfig config = sensor(33);
  const CameraCharacterisation c =
      characterise_camera(record(config, 0.0, 20), record_all(config, {400.0, 1600.0}, 20)).value();
  EXPECT_FALSE(c.saturation_reached);
  EXPECT_NEAR(c.saturation_counts.value, 1660.0, 5.0);
  const std::string warnings = [&c] {
    std::string out;
    for (const std::string& warning : camera_warnings(c)) out += warning + "\n";
    return out;
  }();
  EXPECT_NE(warnings.find("no sequence reached saturation"), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("no level is near saturation"), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("rests on 2 levels"), std::string::npos) << warnings;
  EXPECT_EQ(warnings.find("not flat"), std::string::npos) << warnings;
}

TEST(CameraCharacterisation, WarnsOfWhatIsOdd) {
  sim::SpeckleConfig config = sensor(34);
  config.noise_mean_counts = 5.0;
  config.bit_depth = 8;
  const CameraCharacterisation c =
      characterise_camera(record(config, 0.0, 4), record_all(config, {160.0, 40.0, 41.0}, 4, 0.3))
          .value();
  std::string warnings;
  for (const std::string& warning : camera_warnings(c)) warnings += warning + "\n";
  for (const char* says :
       {"light160: 4 frames are few", "not given from dim to bright",
        "light41: is about as bright as light40", "varies by 31 %", "of the dark counts are 0"})
    EXPECT_NE(warnings.find(says), std::string::npos) << says << " in\n" << warnings;
  config = sensor(34);
  config.noise_sd_counts = 0.2;
  config.bit_depth = 8;
  config.noise_mean_counts = 30.0;
  const CameraCharacterisation quiet =
      characterise_camera(record(config, 0.0, 20), record_all(config, {40.0, 100.0}, 20)).value();
  bool told = false;
  for (const std::string& warning : camera_warnings(quiet))
    told = told || warning.find("drowns in the rounding") != std::string::npos;
  EXPECT_TRUE(told);
  EXPECT_NEAR(quiet.dark_noise_counts.value, 0.2, 2.0 * quiet.dark_noise_counts.sigma);
}

TEST(CameraCharacterisation, LinearityNeedsExposures) {
  const sim::SpeckleConfig config = sensor(35);
  const LightSequence dark = record(config, 0.0, 16);
  std::vector<LightSequence> flats = record_all(config, {300.0, 900.0, 1500.0, 2100.0, 2700.0}, 16);
  const Measured straight = characterise_camera(dark, flats).value().linearity.error_ratio;
  for (LightSequence& flat : flats) flat.exposure_us *= 1.0 + flat.exposure_us / 30000.0;
  const Measured bent = characterise_camera(dark, flats).value().linearity.error_ratio;
  for (LightSequence& flat : flats) flat.exposure_us = kUnknown;
  const Measured unknown = characterise_camera(dark, flats).value().linearity.error_ratio;
  std::printf("linearity error %.4f +- %.4f %%, bent %.2f %%\n", 100.0 * straight.value,
              100.0 * straight.sigma, 100.0 * bent.value);
  EXPECT_LT(straight.value, 4.0 * straight.sigma);
  EXPECT_GT(bent.value, 0.005);
  EXPECT_TRUE(std::isnan(unknown.value));
}

void expect_refusal(const Result<CameraCharacterisation>& result, const std::string& names,
                    const std::string& says) {
  ASSERT_FALSE(result) << says;
  EXPECT_EQ(result.error().code, ErrorCode::bad_input);
  EXPECT_EQ(result.error().message.rfind(names + ": ", 0), 0U) << result.error().message;
  EXPECT_NE(result.error().message.find(says), std::string::npos) << result.error().message;
}

TEST(CameraCharacterisation, RefusesWhatDoesNotFitTogether) {
  const sim::SpeckleConfig config = sensor(36);
  const LightSequence dark = record(config, 0.0, 6);
  const std::vector<LightSequence> flats = record_all(config, {500.0, 1500.0}, 6);
  const auto with = [&flats](const LightSequence& flat) {
    return std::vector<LightSequence>{flats[0], flat};
  };
  sim::SpeckleConfig narrow = config;
  narrow.width_px = 64;
  expect_refusal(characterise_camera(dark, with(record(narrow, 900.0, 4))), "light900",
                 "is 64 x 64 px with 12 bit, but the dark frames are 72 x 64 px");
  sim::SpeckleConfig shallow = config;
  shallow.bit_depth = 10;
  expect_refusal(characterise_camera(dark, with(record(shallow, 900.0, 4))), "light900", "10 bit");
  expect_refusal(characterise_camera(dark, with(record(config, 900.0, 1))), "light900",
                 "one frame only");
  expect_refusal(characterise_camera(record(config, 0.0, 1), flats), "light0", "one frame only");
  expect_refusal(characterise_camera(dark, {flats[0]}), "light0", "two or more");
  expect_refusal(characterise_camera(flats[1], {dark, flats[0]}), "light0",
                 "are --dark and --flat exchanged?");
  expect_refusal(characterise_camera(dark, record_all(config, {4300.0, 5000.0}, 4)), "light4300",
                 "even the dimmest light saturates");
  expect_refusal(characterise_camera(dark, record_all(config, {500.0, 501.0}, 4)), "light0",
                 "of the same light");
  expect_refusal(characterise_camera(dark, record_all(config, {500.0, 3500.0}, 4)), "light0",
                 "only one lies there");
  sim::SpeckleConfig tiny = config;
  tiny.width_px = 31;
  expect_refusal(characterise_camera(record(tiny, 0.0, 4), record_all(tiny, {500.0, 900.0}, 4)),
                 "light0", "32 x 32 px is the least");
  sim::SpeckleConfig averaged = config;
  averaged.full_well_electrons.reset();
  expect_refusal(
      characterise_camera(record(averaged, 0.0, 6), record_all(averaged, {500.0, 1500.0}, 6)),
      "light1500", "noise does not grow");
  sim::SpeckleConfig black = config;
  black.noise_mean_counts = 0.0;
  black.sensor.dsnu_counts = 0.0;
  expect_refusal(characterise_camera(record(black, 0.0, 6), flats), "light0",
                 "raise the black level");
}

TEST(WithCamera, TheCalibrationFileHoldsTheFigures) {
  const sim::SpeckleConfig config = sensor(37);
  const CameraCharacterisation c =
      characterise_camera(record(config, 0.0, 20), record_all(config, kLevels_counts, 20)).value();
  Calibration made = with_camera(test::bridget_calibration(), c);
  made.camera->date = "2026-11-24";
  made.camera->method = "bench";
  made.camera->inputs_sha256 = sha256_hex("frames");
  const Result<Calibration> read = parse_calibration(calibration_text(made), "c.toml");
  ASSERT_TRUE(read) << read.error().message;
  const CameraRecord& record = *read.value().camera;
  EXPECT_EQ(record.k_counts_per_e, c.transfer.k_counts_per_e.value);
  EXPECT_EQ(record.sigma_dsnu_e, c.dsnu_e.sigma);
  EXPECT_EQ(record.prnu_ratio, c.prnu_ratio.value);
  EXPECT_EQ(record.saturation_e, c.saturation_e.value);
  EXPECT_TRUE(record.saturation_reached);
  EXPECT_EQ(record.dark_frames, 20);
  EXPECT_EQ(record.flat_frames, 120);
  EXPECT_EQ(record.flat_levels, 6);
  EXPECT_EQ(record.date, "2026-11-24");
  EXPECT_EQ(read.value().noise_mean_counts, c.mu_dark_counts.value);
  EXPECT_NEAR(read.value().noise_sd_counts, 2.5, 0.05);
  EXPECT_EQ(read.value().format->width_px, 72);
  EXPECT_EQ(read.value().format->bit_depth, 12);
  EXPECT_EQ(read.value().sc_x_ratio, test::bridget_calibration().sc_x_ratio);
}

}  // namespace
}  // namespace lsv
