// SPDX-License-Identifier: BSD-3-Clause
// From light to counts, reproducibility, and settings that must be refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/camera_counts.h"
#include "tests/sim/speckle_frames.h"

namespace lsv::sim {
namespace {

std::uint64_t fnv1a(const Frame& frame) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const int value : counts(frame)) {
    for (const int byte : {value & 0xff, value >> 8}) {
      hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3;
    }
  }
  return hash;
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr PatternMotion kMotion{12.375, -3.8, 1.5, 0.25};

TEST(SpeckleCamera, TheSameSettingsGiveTheSameBytes) {
  SpeckleConfig config;
  config.rho = 0.99;
  config.exposure_ratio = 0.5;
  config.full_well_electrons = 10000.0;
  SpeckleCamera a = make_camera(config);
  SpeckleCamera b = make_camera(config);
  for (int frame = 0; frame < 3; ++frame)
    EXPECT_EQ(counts(render(a, frame, kMotion)), counts(render(b, frame, kMotion)));
}

// The same on every compiler: a change here changes every data set made with the simulator.
TEST(SpeckleCamera, GoldenFrames) {
  SpeckleConfig config;
  config.seed = 42;
  SpeckleCamera camera = make_camera(config);
  EXPECT_EQ(fnv1a(render(camera, 7, kMotion)), 11517965172785741271U);

  config.width_px = 75;
  config.height_px = 49;
  config.speckle_px = 2.4;
  config.bit_depth = 12;
  config.rho = 0.9;
  config.exposure_ratio = 0.4;
  config.full_well_electrons = 8000.0;
  SpeckleCamera all = make_camera(config);
  (void)render(all, 0, {});
  EXPECT_EQ(fnv1a(render(all, 3, kMotion)), 4703296523853629444U);
}

TEST(SpeckleCamera, AnyOrderOfFramesGivesTheSameFramesWithoutBoiling) {
  SpeckleCamera a = make_camera({});
  SpeckleCamera b = make_camera({});
  const auto third = counts(render(a, 3, kMotion));
  const auto first = counts(render(a, 1, {}));
  EXPECT_EQ(counts(render(b, 1, {})), first);
  EXPECT_EQ(counts(render(b, 3, kMotion)), third);
}

TEST(SpeckleCamera, FramesCarryFormatIndexAndStamp) {
  for (const auto& [width_px, height_px, bit_depth] :
       {std::tuple{33, 57, 8}, std::tuple{128, 64, 10}, std::tuple{1, 1, 12},
        std::tuple{61, 7, 16}}) {
    SpeckleConfig config;
    config.width_px = width_px;
    config.height_px = height_px;
    config.bit_depth = bit_depth;
    config.frame_rate_hz = 3.0;
    SpeckleCamera camera = make_camera(config);
    const Frame frame = render(camera, 4, {});
    EXPECT_EQ(frame.view().format,
              (FrameFormat{width_px, height_px,
                           bit_depth == 8 ? PixelType::mono8 : PixelType::mono16, bit_depth}));
    EXPECT_EQ(frame.index, 4);
    EXPECT_EQ(frame.stamp.ns, 1333333333);
  }
}

TEST(SpeckleCamera, ACameraInTheDarkShowsItsNoise) {
  SpeckleConfig config;
  config.mean_signal_counts = 0.0;
  config.noise_mean_counts = 40.0;
  config.noise_sd_counts = 4.0;
  SpeckleCamera camera = make_camera(config);
  const auto dark = counts(render(camera, 0, {}));
  const auto next = counts(render(camera, 1, {}));
  const double five_sigma = 5.0 / 128.0;
  EXPECT_NEAR(mean(dark), 40.0, 4.0 * five_sigma);
  // Rounding adds the variance 1/12.
  EXPECT_NEAR(standard_deviation(dark), std::sqrt(16.0 + 1.0 / 12.0), 4.0 * five_sigma);
  EXPECT_LT(std::abs(correlation(dark, next)), five_sigma);
  std::vector<int> left(dark.begin(), dark.end() - 1);
  std::vector<int> right(dark.begin() + 1, dark.end());
  EXPECT_LT(std::abs(correlation(left, right)), five_sigma);
}

TEST(SpeckleCamera, TheMeanLevelIsSignalPlusDarkLevel) {
  for (const int bit_depth : {10, 16}) {
    SpeckleConfig config;
    config.width_px = 512;
    config.height_px = 512;
    config.bit_depth = bit_depth;
    config.mean_signal_counts = 0.1 * full_scale_counts(bit_depth);
    config.noise_mean_counts = 20.0;
    SpeckleCamera camera = make_camera(config);
    const double five_sigma = 5.0 / std::sqrt(speckle_count(512.0 * 512.0, config.speckle_px));
    EXPECT_NEAR(mean(counts(render(camera, 0, {}))), *config.mean_signal_counts + 20.0,
                *config.mean_signal_counts * five_sigma);
  }
}

TEST(SpeckleCamera, TheDefaultLevelIsTheSameShareOfFullScaleAtEachDepth) {
  SpeckleConfig config;
  EXPECT_DOUBLE_EQ(mean_signal_counts(config), 60.0);
  config.bit_depth = 12;
  EXPECT_DOUBLE_EQ(mean_signal_counts(config), 60.0 * 4095.0 / 255.0);
}

/// The counts of one pixel value, repeated over a frame.
std::vector<int> flat_counts(const CountsModel& model, double intensity, int bit_depth) {
  const FrameFormat format{128, 128, bit_depth == 8 ? PixelType::mono8 : PixelType::mono16,
                           bit_depth};
  Frame frame(format);
  to_counts(model, 3, std::vector<double>(128 * 128, intensity), frame);
  return counts(frame);
}

TEST(Counts, RoundAndClip) {
  const CountsModel model{.mean_signal_counts = 100.0};
  EXPECT_EQ(flat_counts(model, 0.004, 8)[0], 0);
  EXPECT_EQ(flat_counts(model, 0.006, 8)[0], 1);
  EXPECT_EQ(flat_counts(model, 2.549, 8)[0], 255);
  EXPECT_EQ(flat_counts(model, 1e9, 8)[0], 255);
  EXPECT_EQ(flat_counts(model, 1e9, 10)[0], 1023);
  EXPECT_EQ(flat_counts(model, 1e9, 16)[0], 65535);
  const CountsModel below_zero{.noise_mean_counts = 0.0, .noise_sd_counts = 5.0};
  for (const int value : flat_counts(below_zero, 0.0, 8)) EXPECT_GE(value, 0);
}

TEST(Counts, ShotNoiseIsPoissonInElectrons) {
  // 16 bit, so that rounding to counts adds nothing: 100 counts per electron.
  for (const double electrons : {0.0, 0.5, 3.0, 40.0, 63.9, 64.1, 600.0}) {
    const CountsModel model{.mean_signal_counts = 100.0, .electrons_per_count = 0.01, .seed = 9};
    std::vector<double> caught;
    for (const int value : flat_counts(model, electrons, 16)) caught.push_back(value / 100.0);
    const double five_sigma = 5.0 / 128.0;
    EXPECT_NEAR(mean(caught), electrons, five_sigma * std::sqrt(electrons)) << electrons;
    EXPECT_NEAR(std::pow(standard_deviation(caught), 2), electrons,
                five_sigma * std::sqrt(electrons + 2.0 * electrons * electrons))
        << electrons;
  }
}

TEST(Counts, ShotAndCameraNoiseAreIndependent) {
  const CountsModel shot{.mean_signal_counts = 1000.0, .electrons_per_count = 1.0, .seed = 9};
  const CountsModel camera{.mean_signal_counts = 1000.0, .noise_sd_counts = 30.0, .seed = 9};
  EXPECT_LT(std::abs(correlation(flat_counts(shot, 1.0, 16), flat_counts(camera, 1.0, 16))),
            5.0 / 128.0);
}

TEST(RenderPair, MovesByTheShiftAsked) {
  SpeckleConfig config;
  config.noise_sd_counts = 0.0;
  const auto pair = render_pair(config, 5, 4.0, -2.0);
  ASSERT_TRUE(pair.ok());
  const FrameView first = pair.value().first.view();
  const FrameView second = pair.value().second.view();
  int moved = 0;
  for (int y = 2; y < 128; ++y) {
    for (int x = 0; x < 124; ++x) moved += first.at(x, y) == second.at(x + 4, y - 2);
  }
  // The two differ by 1e-6 counts, so a rare pixel may round the other way.
  EXPECT_GE(moved, 124 * 126 - 2);
  const auto other_seed = render_pair(config, 6, 4.0, -2.0);
  ASSERT_TRUE(other_seed.ok());
  EXPECT_NE(counts(pair.value().first), counts(other_seed.value().first));
}

TEST(SpeckleConfig, RefusesWhatIsOutOfRangeAndNamesIt) {
  using Change = void (*)(SpeckleConfig&);
  struct Case {
    const char* field;
    Change change;
  };
  const Case cases[] = {
      {"width_px", [](SpeckleConfig& c) { c.width_px = 0; }},
      {"width_px", [](SpeckleConfig& c) { c.width_px = std::numeric_limits<int>::max(); }},
      {"height_px", [](SpeckleConfig& c) { c.height_px = -1; }},
      {"frame_rate_hz", [](SpeckleConfig& c) { c.frame_rate_hz = 0.0; }},
      {"frame_rate_hz", [](SpeckleConfig& c) { c.frame_rate_hz = kNan; }},
      {"speckle_px", [](SpeckleConfig& c) { c.speckle_px = 0.0; }},
      {"speckle_px", [](SpeckleConfig& c) { c.speckle_px = kNan; }},
      {"speckle_px", [](SpeckleConfig& c) { c.speckle_px = 1000.0; }},
      {"pixel_side_px", [](SpeckleConfig& c) { c.pixel_side_px = 1.5; }},
      {"exposure_ratio", [](SpeckleConfig& c) { c.exposure_ratio = -0.1; }},
      {"rho", [](SpeckleConfig& c) { c.rho = 1.01; }},
      {"rho", [](SpeckleConfig& c) { c.rho = kNan; }},
      {"bit_depth", [](SpeckleConfig& c) { c.bit_depth = 9; }},
      {"bit_depth", [](SpeckleConfig& c) { c.bit_depth = 64; }},
      {"mean_signal_counts", [](SpeckleConfig& c) { c.mean_signal_counts = kInf; }},
      {"noise_mean_counts", [](SpeckleConfig& c) { c.noise_mean_counts = -1.0; }},
      {"noise_sd_counts", [](SpeckleConfig& c) { c.noise_sd_counts = kNan; }},
      {"full_well_electrons", [](SpeckleConfig& c) { c.full_well_electrons = 0.0; }},
      {"simulation samples",
       [](SpeckleConfig& c) {
         c.width_px = 4096;
         c.height_px = 4096;
       }},
  };
  for (const auto& [field, change] : cases) {
    SpeckleConfig config;
    change(config);
    const auto camera = SpeckleCamera::create(config);
    ASSERT_FALSE(camera.ok()) << field;
    EXPECT_EQ(camera.error().code, ErrorCode::invalid_argument);
    EXPECT_NE(camera.error().message.find(field), std::string::npos) << camera.error().message;
  }
}

TEST(SpeckleCamera, RefusesImpossibleMotion) {
  SpeckleConfig config;
  config.rho = 0.9;
  config.exposure_ratio = 1.0;
  SpeckleCamera camera = make_camera(config);
  Frame frame;
  EXPECT_FALSE(camera.render(-1, {}, frame).ok());
  EXPECT_FALSE(camera.render(std::int64_t{1} << 32, {}, frame).ok());
  EXPECT_FALSE(camera.render(0, {kNan, 0.0, 0.0, 0.0}, frame).ok());
  EXPECT_FALSE(camera.render(0, {0.0, 1e30, 0.0, 0.0}, frame).ok());
  EXPECT_FALSE(camera.render(0, {0.0, 0.0, kNan, 0.0}, frame).ok());
  EXPECT_FALSE(camera.render(0, {0.0, 0.0, 0.0, 1e9}, frame).ok());
  EXPECT_TRUE(camera.render(5, {}, frame).ok());
  EXPECT_FALSE(camera.render(4, {}, frame).ok()) << "boiling cannot run backwards";
  EXPECT_TRUE(camera.render(5, {}, frame).ok());
}

}  // namespace
}  // namespace lsv::sim
