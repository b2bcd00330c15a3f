// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/scale_ratio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "tests/calibration/simulated_drive.h"
#include "tests/support/calibration.h"

namespace lsv {
namespace {

using test::body_reference;
using test::sensor_track;

constexpr double kDuration_s = 60.0;
constexpr sim::SensorPlace kFront{.x_m = 0.30, .y_m = 0.15, .yaw_rad = 0.05};
constexpr sim::SensorPlace kRear{.x_m = -0.25, .y_m = -0.15, .yaw_rad = -1.5, .reads_ratio = 1.001};

sim::BodyDrive mixed_drive() { return sim::figure_drive(kDuration_s, 0.1, 0.5); }

BodyReference noisy_reference(const sim::BodyDrive& drive, std::uint64_t seed,
                              double rate_hz = 20.0) {
  return body_reference(drive, {.rate_hz = rate_hz,
                                .end_s = kDuration_s,
                                .sigma_m = 1e-3,
                                .sigma_yaw_rad = 1e-3,
                                .seed = seed});
}

SensorTrack noisy_track(const sim::BodyDrive& drive, const sim::SensorPlace& place,
                        std::uint64_t seed, double rate_hz = 200.0) {
  return sensor_track(drive, place,
                      {.rate_hz = rate_hz, .end_s = kDuration_s, .sigma_m = 5e-8, .seed = seed});
}

ScaleRatio fitted(const BodyReference& reference, const SensorTrack& first,
                  const SensorTrack& second) {
  const Result<ScaleRatio> out =
      fit_scale_ratio(reference, {.track = first}, {.track = second}, Baseline::from_motion);
  EXPECT_TRUE(out) << (out ? "" : out.error().message);
  return out ? out.value() : ScaleRatio{};
}

// 100 repetitions: within 2 sigma in at least 90 %, the sigma right to 20 %.
TEST(ScaleRatio, SigmaIsHonest) {
#ifdef LSV_SANITIZED
  GTEST_SKIP() << "100 fits; under a sanitizer more of the same says nothing more";
#endif
  constexpr int kRepetitions = 100;
  const sim::BodyDrive drive = mixed_drive();
  double sum_squares = 0.0;
  double sum_variances = 0.0;
  int within = 0;
  for (unsigned k = 0; k < kRepetitions; ++k) {
    const ScaleRatio fit =
        fitted(noisy_reference(drive, 100 + k), noisy_track(drive, kFront, 3000 + k, 100.0),
               noisy_track(drive, kRear, 7000 + k, 100.0));
    const double error = fit.ratio - kRear.reads_ratio;
    sum_squares += error * error;
    sum_variances += fit.sigma_ratio * fit.sigma_ratio;
    if (std::abs(error) <= 2.0 * fit.sigma_ratio) ++within;
  }
  const double ratio = std::sqrt(sum_squares / sum_variances);
  std::printf("ratio: within 2 sigma %d of %d, error / sigma %.3f\n", within, kRepetitions, ratio);
  EXPECT_GE(within, kRepetitions * 9 / 10);
  EXPECT_NEAR(ratio, 1.0, 0.2);
}

TEST(ScaleRatio, ReachesTheAccuracyAimedAt) {
  const sim::BodyDrive drive = sim::slalom(kDuration_s, 0.1, 0.5, 6.0);
  const ScaleRatio fit =
      fitted(noisy_reference(drive, 1, 50.0), noisy_track(drive, kFront, 2, 500.0),
             noisy_track(drive, kRear, 3, 500.0));
  std::printf("slalom: sigma of the ratio %.2g\n", fit.sigma_ratio);
  EXPECT_LT(fit.sigma_ratio, 2e-4);
  EXPECT_NEAR(fit.ratio, kRear.reads_ratio, 3.5 * fit.sigma_ratio);
  EXPECT_NEAR(fit.yaw_rad, kRear.yaw_rad - kFront.yaw_rad, 3.5 * fit.sigma_yaw_rad);
  EXPECT_EQ(fit.sigma_factor, 1.0);
}

// The other way round it is the inverse; and whoever reads too little is below 1.
TEST(ScaleRatio, SecondOverFirst) {
  const sim::BodyDrive drive = mixed_drive();
  const BodyReference reference = noisy_reference(drive, 4);
  const SensorTrack front = noisy_track(drive, kFront, 5);
  const SensorTrack rear = noisy_track(drive, kRear, 6);
  const ScaleRatio forth = fitted(reference, front, rear);
  const ScaleRatio back = fitted(reference, rear, front);
  EXPECT_NEAR(forth.ratio * back.ratio, 1.0, 1e-6);
  EXPECT_NEAR(forth.yaw_rad, -back.yaw_rad, 1e-5);
  EXPECT_GT(forth.ratio, 1.0);
}

// The scale of the reference, and its place, do not come in.
TEST(ScaleRatio, TheReferenceGivesItsHeadingOnly) {
  const sim::BodyDrive drive = mixed_drive();
  BodyReference reference = noisy_reference(drive, 7);
  const SensorTrack front = noisy_track(drive, kFront, 8);
  const SensorTrack rear = noisy_track(drive, kRear, 9);
  const ScaleRatio before = fitted(reference, front, rear);
  for (ReferencePose& pose : reference) {
    pose.x_m *= 1.1;
    pose.y_m = 7.0;
  }
  EXPECT_EQ(fitted(reference, front, rear).ratio, before.ratio);
}

TEST(ScaleRatio, StraightStretchesNeedTheLeverArms) {
  const sim::BodyDrive drive = sim::straight(kDuration_s, 0.1);
  const BodyReference reference = noisy_reference(drive, 10);
  const Mount front{kFront.x_m, kFront.y_m, kFront.yaw_rad, 2e-3, 2e-3, 1e-3};
  const Mount rear{kRear.x_m, kRear.y_m, kRear.yaw_rad, 2e-3, 2e-3, 1e-3};
  const PairSensor first{.track = noisy_track(drive, kFront, 11), .mount = front};
  const PairSensor second{.track = noisy_track(drive, kRear, 12), .mount = rear};
  const Result<ScaleRatio> refused =
      fit_scale_ratio(reference, first, second, Baseline::from_motion);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("lever arms"), std::string::npos);
  const Result<ScaleRatio> fit = fit_scale_ratio(reference, first, second, Baseline::from_mounts);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit.value().ratio, kRear.reads_ratio, 3.5 * fit.value().sigma_ratio);
  EXPECT_LT(fit.value().sigma_ratio, 1e-4);
}

// Shifts that were accepted and wrong, by the search range of a tracker; poses that turn round.
TEST(ScaleRatio, GrossOutliersAreLeftOut) {
  const sim::BodyDrive drive = mixed_drive();
  BodyReference reference = noisy_reference(drive, 13);
  SensorTrack rear = noisy_track(drive, kRear, 14);
  for (std::size_t i = 500; i < rear.size(); i += 2000) rear[i].dx_m += 2e-4;
  for (std::size_t i = 40; i < reference.size(); i += 200) reference[i].yaw_rad += 0.1;
  const ScaleRatio fit = fitted(reference, noisy_track(drive, kFront, 15), rear);
  EXPECT_NEAR(fit.ratio, kRear.reads_ratio, 3.5 * fit.sigma_ratio);
  EXPECT_LT(fit.sigma_ratio, 1e-4);
  EXPECT_GE(fit.outliers, 6U);
}

/// Each sensor shaken about its place, by 20 um from step to step.
SensorTrack shaken(SensorTrack track, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 2e-5);
  double before_x_m = 0.0;
  double before_y_m = 0.0;
  for (TrackStep& step : track) {
    const double x_m = normal(random);
    const double y_m = normal(random);
    step.dx_m += x_m - before_x_m;
    step.dy_m += y_m - before_y_m;
    before_x_m = x_m;
    before_y_m = y_m;
  }
  return track;
}

// A frame that gives way is found out; it costs accuracy, not truth, and far less than if every
// step were that uncertain.
TEST(ScaleRatio, ARigThatGivesWay) {
  const sim::BodyDrive drive = mixed_drive();
  const ScaleRatio fit =
      fitted(noisy_reference(drive, 16), shaken(noisy_track(drive, kFront, 17), 18),
             shaken(noisy_track(drive, kRear, 19), 20));
  EXPECT_NEAR(fit.rig_sigma_m, 2e-5 * std::numbers::sqrt2, 0.5e-5);
  EXPECT_NEAR(fit.ratio, kRear.reads_ratio, 3.5 * fit.sigma_ratio);
  EXPECT_LT(fit.sigma_ratio, 5e-5);
  EXPECT_LT(fit.sigma_factor, 1.1);
}

TEST(ScaleRatio, ClocksOfTheSensorsMayDiffer) {
  const sim::BodyDrive drive = mixed_drive();
  const SensorTrack rear = sensor_track(drive, kRear,
                                        {.rate_hz = 200.0,
                                         .end_s = kDuration_s,
                                         .clock_ahead_s = 0.003,
                                         .sigma_m = 5e-8,
                                         .seed = 21});
  const ScaleRatio fit = fitted(noisy_reference(drive, 22), noisy_track(drive, kFront, 23), rear);
  EXPECT_NEAR(fit.clock_offset_s, -0.003, 1e-4);
  EXPECT_NEAR(fit.ratio, kRear.reads_ratio, 3.5 * fit.sigma_ratio);
  EXPECT_LT(fit.sigma_ratio, 1e-4);
}

// Ground that one of them lost, at an offset of the clocks that moves the gap over whole links.
TEST(ScaleRatio, GapsDoNotBias) {
  const sim::BodyDrive drive = mixed_drive();
  const auto lossy = [&drive](const sim::SensorPlace& place, double ahead_s, std::uint64_t seed) {
    return sensor_track(drive, place,
                        {.rate_hz = 200.0,
                         .end_s = kDuration_s,
                         .clock_ahead_s = ahead_s,
                         .sigma_m = 5e-8,
                         .refused_ratio = 0.02,
                         .lost = {{10.0 + 20.0 * ahead_s, 12.0}, {30.0, 30.5}},
                         .seed = seed});
  };
  const ScaleRatio fit =
      fitted(noisy_reference(drive, 24, 50.0), lossy(kFront, 0.0, 25), lossy(kRear, 0.06, 26));
  EXPECT_NEAR(fit.ratio, kRear.reads_ratio, 3.5 * fit.sigma_ratio);
  EXPECT_LT(fit.sigma_ratio, 1e-4);
  EXPECT_NEAR(fit.clock_offset_s, -0.06, 1e-4);
  EXPECT_EQ(fit.outliers, 0U);
}

// ---- false yaw --------------------------------------------------------------------------------

/// Two sensors side by side.
TEST(FalseYaw, TheSideThatReadsTooMuchIsTurnedFrom) {
  const Mount right{.x_m = 0.0, .y_m = -0.15};
  const Mount left{.x_m = 0.0, .y_m = 0.15};
  // (ratio - 1) / B; the left reads more, so it seems to run ahead: a turn to the right.
  EXPECT_NEAR(false_yaw_rad_per_m(1.001, right, left), -1e-3 / 0.3, 1e-12);
  EXPECT_NEAR(false_yaw_rad_per_m(1.001, left, right), 1e-3 / 0.3, 1e-12);
  const Mount front{.x_m = 0.5, .y_m = 0.15};
  EXPECT_NEAR(false_yaw_rad_per_m(1.001, left, front), 0.0, 1e-12);
  EXPECT_TRUE(std::isnan(false_yaw_rad_per_m(1.001, left, left)));
}

// The law against a drive: straight ahead, turning as the two tracks have it.
TEST(FalseYaw, IsWhatThePairSees) {
  const sim::BodyDrive drive = sim::straight(20.0, 0.1);
  const sim::TrackingConfig config{.rate_hz = 50.0, .end_s = 20.0};
  const auto forward_m = [&](const sim::SensorPlace& place) {
    double out = 0.0;
    for (const TrackStep& step : sensor_track(drive, place, config)) out += step.dx_m;
    return out;
  };
  const sim::SensorPlace left{.y_m = 0.2};
  const sim::SensorPlace right{.y_m = -0.1, .reads_ratio = 1.002};
  const double way_m = drive.way(20.0).way_m;
  const double seen_rad = (forward_m(right) - forward_m(left)) / 0.3;  // to the left
  EXPECT_NEAR(false_yaw_rad_per_m(1.002, {.x_m = 0.0, .y_m = 0.2}, {.x_m = 0.0, .y_m = -0.1}),
              seen_rad / way_m, 1e-9);
}

TEST(FalseYaw, TheCorrectionTakesTheRatioOut) {
  const Calibration before = test::bridget_calibration();
  const Calibration after = with_reading_divided(before, 1.001);
  // travel = shift pitch / Sc
  EXPECT_NEAR(after.sc_x_ratio / before.sc_x_ratio, 1.001, 1e-12);
  EXPECT_NEAR(after.sc_y_ratio / before.sc_y_ratio, 1.001, 1e-12);
}

}  // namespace
}  // namespace lsv
