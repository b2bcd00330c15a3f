// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/mount_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "calibration/mount_stretches.h"
#include "tests/calibration/simulated_drive.h"

namespace lsv {
namespace {

using test::body_reference;
using test::sensor_track;

constexpr double kDuration_s = 60.0;
constexpr sim::SensorPlace kFront{.x_m = 0.30, .y_m = 0.15, .yaw_rad = 0.05};

sim::BodyDrive slalom_drive() { return sim::slalom(kDuration_s, 0.1, 0.5, 6.0); }
sim::BodyDrive mixed_drive() { return sim::figure_drive(kDuration_s, 0.1, 0.5); }

sim::ReferenceConfig noisy_reference(std::uint64_t seed, double rate_hz = 20.0) {
  return {.rate_hz = rate_hz,
          .end_s = kDuration_s,
          .sigma_m = 1e-3,
          .sigma_yaw_rad = 1e-3,
          .seed = seed};
}

sim::TrackingConfig tracking(std::uint64_t seed, double rate_hz = 200.0) {
  return {.rate_hz = rate_hz, .end_s = kDuration_s, .sigma_m = 5e-8, .seed = seed};
}

double sigma(const MountFit& fit, std::size_t i) { return std::sqrt(fit.cov[i][i]); }

/// Error in sigmas of x, y and yaw, the largest.
double worst_sigmas(const MountFit& fit, const sim::SensorPlace& truth) {
  return std::max({std::abs(fit.x_m - truth.x_m) / sigma(fit, 0),
                   std::abs(fit.y_m - truth.y_m) / sigma(fit, 1),
                   std::abs(std::remainder(fit.yaw_rad - truth.yaw_rad, 2.0 * std::numbers::pi)) /
                       sigma(fit, 2)});
}

MountFit fitted(const BodyReference& reference, const SensorTrack& track,
                const MountOptions& options = {}) {
  const Result<MountFit> out = fit_mount(reference, track, options);
  EXPECT_TRUE(out) << (out ? "" : out.error().message);
  return out ? out.value() : MountFit{};
}

std::string refusal(const BodyReference& reference, const SensorTrack& track,
                    const MountOptions& options = {}) {
  const Result<MountFit> out = fit_mount(reference, track, options);
  return out ? "nothing was refused" : out.error().message;
}

/// All four quarters of yaw and of place.
TEST(MountFit, RecoversExactMountsAllAround) {
  const sim::BodyDrive drive = mixed_drive();
  const BodyReference reference = body_reference(drive, {.rate_hz = 50.0, .end_s = kDuration_s});
  for (const sim::SensorPlace& place :
       {sim::SensorPlace{0.3, 0.15, 0.05}, sim::SensorPlace{-0.4, 0.2, 1.7},
        sim::SensorPlace{-0.25, -0.1, -3.0}, sim::SensorPlace{0.1, -0.5, -1.4},
        sim::SensorPlace{0.0, 0.0, 0.0}}) {
    const MountFit fit =
        fitted(reference, sensor_track(drive, place, {.rate_hz = 500.0, .end_s = kDuration_s}));
    EXPECT_NEAR(fit.x_m, place.x_m, 1e-5);
    EXPECT_NEAR(fit.y_m, place.y_m, 1e-5);
    EXPECT_NEAR(fit.yaw_rad, place.yaw_rad, 1e-5);
    EXPECT_EQ(fit.gaps, 0U);
    EXPECT_EQ(fit.outliers, 0U);
  }
}

// The claim of the calibration: 100 repetitions, each figure within 2 sigma in at least 90 % of
// them, and the sigmas right to 20 %.
TEST(MountFit, SigmasAreHonest) {
#ifdef LSV_SANITIZED
  GTEST_SKIP() << "100 fits; under a sanitizer more of the same says nothing more";
#endif
  constexpr int kRepetitions = 100;
  const sim::BodyDrive drive = mixed_drive();
  double sum_squares[3] = {};
  double sum_variances[3] = {};
  int within[3] = {};
  for (unsigned k = 0; k < kRepetitions; ++k) {
    const MountFit fit = fitted(body_reference(drive, noisy_reference(100 + k, 10.0)),
                                sensor_track(drive, kFront, tracking(5000 + k, 50.0)));
    const double errors[] = {fit.x_m - kFront.x_m, fit.y_m - kFront.y_m,
                             fit.yaw_rad - kFront.yaw_rad};
    for (std::size_t i = 0; i < 3; ++i) {
      sum_squares[i] += errors[i] * errors[i];
      sum_variances[i] += fit.cov[i][i];
      if (errors[i] * errors[i] <= 4.0 * fit.cov[i][i]) ++within[i];
    }
  }
  for (int i = 0; i < 3; ++i) {
    const double ratio = std::sqrt(sum_squares[i] / sum_variances[i]);
    std::printf("figure %d: within 2 sigma %d of %d, error / sigma %.3f\n", i, within[i],
                kRepetitions, ratio);
    EXPECT_GE(within[i], kRepetitions * 9 / 10) << i;
    EXPECT_NEAR(ratio, 1.0, 0.2) << i;
  }
}

TEST(MountFit, ReachesTheAccuracyAimedAt) {
  const sim::BodyDrive drive = slalom_drive();
  const MountFit fit = fitted(body_reference(drive, noisy_reference(1, 50.0)),
                              sensor_track(drive, kFront, tracking(2, 500.0)));
  std::printf("slalom: sigma x %.3f mm, y %.3f mm, yaw %.4f mrad\n", 1e3 * sigma(fit, 0),
              1e3 * sigma(fit, 1), 1e3 * sigma(fit, 2));
  EXPECT_LT(sigma(fit, 0), 2e-3);
  EXPECT_LT(sigma(fit, 1), 2e-3);
  EXPECT_LT(sigma(fit, 2), 1e-3);
  EXPECT_LT(worst_sigmas(fit, kFront), 3.5);
  EXPECT_EQ(fit.sigma_factor, 1.0);
}

// Another rate, another start on each side, poses far from the origin: nothing is lost but data.
TEST(MountFit, RatesAndStartsMayDiffer) {
  const sim::BodyDrive drive = mixed_drive();
  sim::ReferenceConfig config = noisy_reference(3);
  config.begin_s = 4.013;
  BodyReference reference = body_reference(drive, config);
  for (ReferencePose& pose : reference) {
    pose.x_m += 4.5e6;
    pose.y_m -= 5e5;
    pose.stamp.ns += 1'700'000'000'000'000'000;
  }
  sim::TrackingConfig track_config = tracking(4, 500.0);
  track_config.begin_s = 0.7;
  track_config.end_s = 55.5;
  SensorTrack track = sensor_track(drive, kFront, track_config);
  for (TrackStep& step : track) {
    step.begin.ns += 1'700'000'000'000'000'000;
    step.end.ns += 1'700'000'000'000'000'000;
  }
  const MountFit fit = fitted(reference, track);
  EXPECT_LT(worst_sigmas(fit, kFront), 3.5);
  EXPECT_LT(sigma(fit, 0), 1e-4);
  EXPECT_EQ(fit.poses, 1030U);
}

// The whole reference turned on the ground: the mount knows nothing of it.
TEST(MountFit, TheGroundFrameDoesNotMatter) {
  const sim::BodyDrive drive = mixed_drive();
  BodyReference reference = body_reference(drive, noisy_reference(5));
  const SensorTrack track = sensor_track(drive, kFront, tracking(6));
  const MountFit before = fitted(reference, track);
  constexpr double kTurn_rad = 2.4;
  for (ReferencePose& pose : reference) {
    const double x_m = pose.x_m;
    pose.x_m = std::cos(kTurn_rad) * x_m - std::sin(kTurn_rad) * pose.y_m;
    pose.y_m = std::sin(kTurn_rad) * x_m + std::cos(kTurn_rad) * pose.y_m;
    pose.yaw_rad = std::remainder(pose.yaw_rad + kTurn_rad, 2.0 * std::numbers::pi);
  }
  const MountFit after = fitted(reference, track);
  EXPECT_NEAR(after.x_m, before.x_m, 1e-8);
  EXPECT_NEAR(after.y_m, before.y_m, 1e-8);
  EXPECT_NEAR(after.yaw_rad, before.yaw_rad, 1e-8);
}

// ---- what a drive must have -------------------------------------------------------------------

TEST(MountFit, WithoutTurningThereIsNoLeverArm) {
  const sim::BodyDrive drive = sim::straight(kDuration_s, 0.1);
  const BodyReference reference = body_reference(drive, noisy_reference(7));
  const SensorTrack track = sensor_track(drive, kFront, tracking(8));
  EXPECT_NE(refusal(reference, track).find("without turning the lever arm is unknown"),
            std::string::npos)
      << refusal(reference, track);
  // Measured by hand, it stands in.
  const MountOptions options{.lever = KnownLever{.x_m = 0.301, .y_m = 0.149, .sigma_m = 0.002}};
  const MountFit fit = fitted(reference, track, options);
  EXPECT_NEAR(fit.x_m, 0.301, 1e-4);
  EXPECT_NEAR(sigma(fit, 0), 0.002, 1e-4);
  EXPECT_NEAR(fit.yaw_rad, kFront.yaw_rad, 3.5 * sigma(fit, 2));
  EXPECT_LT(sigma(fit, 2), 1e-4);
}

// With curves the hand measurement is one among many.
TEST(MountFit, AKnownLeverIsWeighedWithTheDrive) {
  const sim::BodyDrive drive = mixed_drive();
  const MountOptions options{.lever = KnownLever{.x_m = 0.302, .y_m = 0.148, .sigma_m = 0.002}};
  const MountFit fit = fitted(body_reference(drive, noisy_reference(9)),
                              sensor_track(drive, kFront, tracking(10)), options);
  EXPECT_LT(worst_sigmas(fit, kFront), 3.5);
  EXPECT_LT(sigma(fit, 0), 1e-4);
}

TEST(MountFit, WithoutDrivingThereIsNoYaw) {
  const sim::BodyDrive drive({{.duration_s = 1.0, .speed_m_s = 1e-9}});
  const std::string why = refusal(body_reference(drive, noisy_reference(11)),
                                  sensor_track(drive, kFront, tracking(12)));
  EXPECT_NE(why.find("without driving the yaw"), std::string::npos) << why;
}

TEST(MountFit, OneCircleDoesNotTellYawFromLeverArm) {
  const sim::BodyDrive drive = sim::circle(kDuration_s, 0.1, 0.4);
  const std::string why = refusal(body_reference(drive, noisy_reference(13)),
                                  sensor_track(drive, kFront, tracking(14)));
  EXPECT_NE(why.find("cannot be told apart"), std::string::npos) << why;
  EXPECT_NE(why.find("one radius"), std::string::npos) << why;
}

TEST(MountFit, TurningOnTheSpotIsNoDrive) {
  const sim::BodyDrive drive({{1.0, 0.0, 0.5}, {kDuration_s - 1.0, 0.0, 0.5}});
  const std::string why = refusal(body_reference(drive, noisy_reference(15)),
                                  sensor_track(drive, kFront, tracking(16)));
  EXPECT_NE(why.find("without driving the yaw"), std::string::npos) << why;
}

TEST(MountFit, TimesThatDoNotMeetAreRefused) {
  const sim::BodyDrive drive = mixed_drive();
  SensorTrack track = sensor_track(drive, kFront, tracking(17));
  for (TrackStep& step : track) {
    step.begin.ns += 1'000'000'000'000;
    step.end.ns += 1'000'000'000'000;
  }
  const std::string why = refusal(body_reference(drive, noisy_reference(18)), track);
  EXPECT_NE(why.find("only 0 reference poses lie within the track"), std::string::npos) << why;
  EXPECT_NE(refusal({}, track).find("only 0"), std::string::npos);
  EXPECT_NE(refusal(body_reference(drive, noisy_reference(18)), {}).find("only 0"),
            std::string::npos);
}

// ---- signs ------------------------------------------------------------------------------------

SensorTrack with_y_turned_round(SensorTrack track) {
  for (TrackStep& step : track) step.dy_m = -step.dy_m;
  return track;
}

// Without slipping sideways, a mirrored sensor is one on the other side of the axle: the law behind
// mirrored_mount(), which names the other.
TEST(MountFit, AMirroredSensorSeemsToSitBehindTheAxle) {
  const sim::BodyDrive drive = mixed_drive();
  const BodyReference reference = body_reference(drive, noisy_reference(19));
  const SensorTrack track = sensor_track(drive, kFront, tracking(20));
  const MountFit fit = fitted(reference, track);
  const MountFit mirror = fitted(reference, with_y_turned_round(track));
  EXPECT_NEAR(mirror.x_m, -fit.x_m, 1e-4);
  EXPECT_NEAR(mirror.y_m, fit.y_m, 1e-4);
  EXPECT_NEAR(mirror.yaw_rad, -fit.yaw_rad, 1e-3);
  const std::optional<Mount> named = mirrored_mount(reference, track, {}, fit);
  ASSERT_TRUE(named);
  EXPECT_NEAR(named->x_m, -0.30, 1e-3);
  EXPECT_NEAR(named->yaw_rad, -0.05, 1e-3);
}

// Where it sits decides; then a mirrored sensor is named, not fitted to something.
TEST(MountFit, MirroredAxesAreNamedWhereTheLeverIsKnown) {
  const sim::BodyDrive drive = mixed_drive();
  const BodyReference reference = body_reference(drive, noisy_reference(19));
  const SensorTrack track = sensor_track(drive, kFront, tracking(20));
  const MountOptions options{.lever = KnownLever{.x_m = 0.30, .y_m = 0.15, .sigma_m = 0.002}};
  const std::string why = refusal(reference, with_y_turned_round(track), options);
  EXPECT_NE(why.find("mirrored"), std::string::npos) << why;
  EXPECT_FALSE(mirrored_mount(reference, track, options, fitted(reference, track, options)));
  // Swapped axes are a mirror and a turn.
  SensorTrack swapped = track;
  for (TrackStep& step : swapped) std::swap(step.dx_m, step.dy_m);
  EXPECT_NE(refusal(reference, swapped, options).find("mirrored"), std::string::npos);
}

// A track that counts the travel of the ground is one of a sensor turned by half a turn.
TEST(MountFit, TravelOfTheGroundIsHalfATurn) {
  const sim::BodyDrive drive = mixed_drive();
  SensorTrack track = sensor_track(drive, kFront, tracking(21));
  for (TrackStep& step : track) {
    step.dx_m = -step.dx_m;
    step.dy_m = -step.dy_m;
  }
  const MountFit fit = fitted(body_reference(drive, noisy_reference(22)), track);
  EXPECT_NEAR(fit.yaw_rad, kFront.yaw_rad - std::numbers::pi, 1e-3);
  EXPECT_NEAR(fit.x_m, kFront.x_m, 1e-3);
}

TEST(MountFit, AHeadingThatTurnsTheWrongWayDoesNotFit) {
  const sim::BodyDrive drive = mixed_drive();
  BodyReference reference = body_reference(drive, noisy_reference(23));
  for (ReferencePose& pose : reference) pose.yaw_rad = -pose.yaw_rad;
  const Result<MountFit> fit = fit_mount(reference, sensor_track(drive, kFront, tracking(24)), {});
  if (fit) {
    EXPECT_GT(fit.value().sigma_factor, 10.0);
  }
}

// ---- refused shifts, outliers -----------------------------------------------------------------

TEST(MountFit, RefusedShiftsDoNotBias) {
  const sim::BodyDrive drive = mixed_drive();
  const BodyReference reference = body_reference(drive, noisy_reference(25, 50.0));
  sim::TrackingConfig config = tracking(26, 500.0);
  config.refused_ratio = 0.05;
  config.lost = {{8.0, 9.5}, {21.0, 21.2}, {40.0, 43.0}};
  const SensorTrack track = sensor_track(drive, kFront, config);
  const MountFit fit = fitted(reference, track);
  EXPECT_LT(worst_sigmas(fit, kFront), 3.5);
  EXPECT_LT(sigma(fit, 0), 1e-4);
  EXPECT_GE(fit.gaps, 3U);
  EXPECT_LE(fit.gaps, 8U);
  EXPECT_EQ(fit.sigma_factor, 1.0);

  // What bridging the losses would do, as the position column of a track does: it shows.
  SensorTrack bridged = track;
  for (std::size_t i = 1; i < bridged.size(); ++i) bridged[i].begin = bridged[i - 1].end;
  const Result<MountFit> wrong = fit_mount(reference, bridged, {});
  if (wrong) {
    EXPECT_GT(wrong.value().sigma_factor, 3.0);
  }
}

// 2 % of the poses far off in place, 2 % in heading, up to half a turn.
TEST(MountFit, GrossOutliersOfTheReferenceAreLeftOut) {
  const sim::BodyDrive drive = mixed_drive();
  BodyReference reference = body_reference(drive, noisy_reference(27));
  std::size_t spoilt = 0;
  for (std::size_t i = 10; i + 10 < reference.size(); i += 50) {
    reference[i].x_m += i % 100 == 10 ? 0.5 : -3.0;
    reference[i + 25].yaw_rad += i % 100 == 10 ? 0.3 : std::numbers::pi;
    spoilt += 2;
  }
  const MountFit fit = fitted(reference, sensor_track(drive, kFront, tracking(28)));
  EXPECT_LT(worst_sigmas(fit, kFront), 3.5);
  EXPECT_EQ(fit.sigma_factor, 1.0);
  EXPECT_EQ(fit.poses + spoilt, reference.size());
}

TEST(MountFit, TooManyOutliersAreNotNoise) {
  const sim::BodyDrive drive = mixed_drive();
  BodyReference reference = body_reference(drive, noisy_reference(29));
  for (std::size_t i = 0; i < reference.size(); i += 5) reference[i].x_m += 0.5;
  const std::string why = refusal(reference, sensor_track(drive, kFront, tracking(30)));
  EXPECT_NE(why.find("more than a tenth"), std::string::npos) << why;
}

TEST(MountFit, AReferenceWorseThanStatedRaisesTheSigmas) {
  const sim::BodyDrive drive = mixed_drive();
  BodyReference reference = body_reference(drive, noisy_reference(31));
  const SensorTrack track = sensor_track(drive, kFront, tracking(32));
  const MountFit stated = fitted(reference, track);
  for (ReferencePose& pose : reference) {
    pose.sigma_m /= 5.0;
    pose.sigma_yaw_rad /= 5.0;
  }
  const MountFit fit = fitted(reference, track);
  EXPECT_NEAR(fit.sigma_factor, 5.0, 0.5);
  EXPECT_NEAR(sigma(fit, 0) / sigma(stated, 0), 1.0, 0.1);
  EXPECT_EQ(fit.outliers, 0U);
}

// ---- scale, clock, stretches ------------------------------------------------------------------

TEST(MountFit, AWrongScaleIsFoundWhenAskedFor) {
  const sim::BodyDrive drive = mixed_drive();
  const BodyReference reference = body_reference(drive, noisy_reference(33));
  sim::SensorPlace place = kFront;
  place.reads_ratio = 1.004;
  const SensorTrack track = sensor_track(drive, place, tracking(34));
  EXPECT_GT(fitted(reference, track).sigma_factor, 1.2);
  const MountFit free =
      fitted(reference, track, {.scale_sigma_ratio = std::numeric_limits<double>::infinity()});
  EXPECT_EQ(free.sigma_factor, 1.0);
  EXPECT_LT(worst_sigmas(free, place), 3.5);
  EXPECT_NEAR(free.scale_ratio, 1.0 / 1.004, 3.5 * sigma(free, 3));
  EXPECT_LT(sigma(free, 3), 2e-4);
  // A calibration that is sure of itself holds it back.
  const MountFit held = fitted(reference, track, {.scale_sigma_ratio = 1e-5});
  EXPECT_NEAR(held.scale_ratio, 1.0, 1e-3);
}

// 120 ms in either direction: far beyond the interval of the reference.
TEST(MountFit, TheClocksAreBroughtTogether) {
  const sim::BodyDrive drive = mixed_drive();
  const BodyReference reference = body_reference(drive, noisy_reference(35));
  for (const double ahead_s : {-0.12, 0.0, 0.12}) {
    sim::TrackingConfig config = tracking(36);
    config.clock_ahead_s = ahead_s;
    const SensorTrack track = sensor_track(drive, kFront, config);
    const MountFit fit = fitted(reference, track, {.fit_clock = true});
    EXPECT_NEAR(fit.clock_offset_s, -ahead_s, 3.5 * sigma(fit, 4));
    EXPECT_LT(sigma(fit, 4), 1e-3);
    EXPECT_LT(worst_sigmas(fit, kFront), 3.5);
    if (ahead_s != 0.0) {
      const Result<MountFit> ignorant = fit_mount(reference, track, {});
      if (ignorant) {
        EXPECT_GT(ignorant.value().sigma_factor, 1.5);
      }
    }
  }
}

TEST(MountStretches, TheBadStretchStandsOut) {
  const sim::BodyDrive drive = mixed_drive();
  BodyReference reference = body_reference(drive, noisy_reference(37));
  const SensorTrack track = sensor_track(drive, kFront, tracking(38));
  const auto good = leave_out_stretches(reference, track, {}, fitted(reference, track));
  ASSERT_EQ(good.size(), 8U);
  for (const MountStretch& stretch : good) {
    EXPECT_LT(std::abs(stretch.misfit_sigmas), 4.0);
    EXPECT_LT(std::abs(stretch.change_x_m), 3e-4);
  }
  // The heading of the reference is off by 0.3 deg in the third stretch.
  for (ReferencePose& pose : reference) {
    if (pose.stamp >= good[2].begin && pose.stamp < good[2].end) pose.yaw_rad += 5e-3;
  }
  const auto bad = leave_out_stretches(reference, track, {}, fitted(reference, track));
  EXPECT_GT(bad[2].misfit_sigmas, 20.0);
  for (const std::size_t i : {0U, 1U, 3U, 4U, 5U, 6U, 7U})
    EXPECT_LT(bad[i].misfit_sigmas, 0.8 * bad[2].misfit_sigmas) << i;
}

}  // namespace
}  // namespace lsv
