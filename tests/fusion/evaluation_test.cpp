// SPDX-License-Identifier: BSD-3-Clause
// Laws of the metrics: what must be zero is zero, what must not change does not, and what is known
// in closed form comes out.
#include "fusion/evaluation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/fusion/trajectories.h"

namespace lsv {
namespace {

using test::normal;
using test::planar_pose;

constexpr double kDegree = std::numbers::pi / 180.0;

TrajectoryEvaluation evaluated(const Trajectory& estimate, const Trajectory& truth,
                               AlignmentKind align = AlignmentKind::none) {
  return evaluate(estimate, truth, {.align = align}).value();
}

/// Turned about the origin and shifted.
Trajectory moved(Trajectory path, double angle_rad, double x_m, double y_m, double scale = 1.0) {
  const Alignment transform{.kind = AlignmentKind::sim3,
                            .rotation = test::turn_about_z(angle_rad),
                            .translation_m = {x_m, y_m, 0.0},
                            .scale = scale};
  for (TrajectoryPose& pose : path.poses) pose = aligned(transform, pose);
  return path;
}

/// As dead reckoning errs: yaw rate biased, distances too long, a start that is off.
Trajectory dead_reckoned(const Trajectory& truth, double scale, double yaw_per_step_rad) {
  Trajectory out = truth;
  double x_m = truth.poses[0].x_m + 0.3, y_m = truth.poses[0].y_m - 0.2;
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    const double off_rad = 0.3 + yaw_per_step_rad * static_cast<double>(i);
    out.poses[i] = planar_pose(0.1 * static_cast<double>(i), x_m, y_m,
                               heading_rad(truth.poses[i].rotation) + off_rad);
    if (i + 1 == truth.poses.size()) break;
    const double dx_m = scale * (truth.poses[i + 1].x_m - truth.poses[i].x_m);
    const double dy_m = scale * (truth.poses[i + 1].y_m - truth.poses[i].y_m);
    x_m += std::cos(off_rad) * dx_m - std::sin(off_rad) * dy_m;
    y_m += std::sin(off_rad) * dx_m + std::cos(off_rad) * dy_m;
  }
  return out;
}

void expect_zero(const ErrorStatistics& errors) {
  EXPECT_GT(errors.count, 0U);
  EXPECT_EQ(errors.rmse, 0.0);
  EXPECT_EQ(errors.mean, 0.0);
  EXPECT_EQ(errors.median, 0.0);
  EXPECT_EQ(errors.max, 0.0);
  EXPECT_EQ(errors.sd, 0.0);
}

TEST(Evaluation, ItselfIsExactlyZeroUnderEveryAlignment) {
  Trajectory planar = test::winding(300);
  std::mt19937 random(65);
  Trajectory space = planar;
  space.is_planar = false;
  for (TrajectoryPose& pose : space.poses) {
    pose.z_m = normal(random);
    double length = 0.0;
    for (double* part : {&pose.rotation.x, &pose.rotation.y, &pose.rotation.z, &pose.rotation.w}) {
      *part = normal(random);
      length += *part * *part;
    }
    for (double* part : {&pose.rotation.x, &pose.rotation.y, &pose.rotation.z, &pose.rotation.w})
      *part /= std::sqrt(length);
  }
  for (const Trajectory& path : {planar, space}) {
    for (const AlignmentKind kind : kAllAlignmentKinds) {
      SCOPED_TRACE(std::string(word(kind)) + (path.is_planar ? ", planar" : ", in space"));
      const TrajectoryEvaluation out = evaluated(path, path, kind);
      expect_zero(out.position_m);
      expect_zero(out.rotation_rad);
      expect_zero(out.heading_rad);
      expect_zero(out.rpe_m.translation_m);
      expect_zero(out.rpe_m.rotation_rad);
      expect_zero(out.rpe_s.translation_m);
      EXPECT_EQ(out.drift_percent, 0.0);
      EXPECT_EQ(out.end_error_m, 0.0);
      for (const double rmse_m : out.ate_rmse_by_alignment_m) EXPECT_EQ(rmse_m, 0.0);
      EXPECT_EQ(out.pairs.max_dt_s, 0.0);
    }
  }
}

// One pair of trajectories has as many errors as there are alignments: one must be named.
TEST(Evaluation, EachAlignmentLeavesAnotherError) {
  const Trajectory truth = test::winding(400);
  const Trajectory estimate = dead_reckoned(truth, 1.05, 0.0005);
  const TrajectoryEvaluation out = evaluated(estimate, truth);
  const auto& [none_m, origin_m, se2_m, se3_m, sim3_m] = out.ate_rmse_by_alignment_m;
  EXPECT_GT(none_m, 1.2 * origin_m);
  EXPECT_GT(origin_m, 1.2 * se2_m);
  EXPECT_NEAR(se3_m, se2_m, 1e-9);  // in a plane
  EXPECT_GT(se2_m, 1.2 * sim3_m);
  EXPECT_GT(sim3_m, 1e-3);
  for (std::size_t i = 0; i < kAllAlignmentKinds.size(); ++i) {
    EXPECT_EQ(evaluated(estimate, truth, kAllAlignmentKinds[i]).position_m.rmse,
              out.ate_rmse_by_alignment_m[i]);
  }
}

// No other transform of the kind does better.
TEST(Evaluation, TheFitIsTheBestOfItsKind) {
  const Trajectory truth = test::winding(400);
  const Trajectory estimate = dead_reckoned(truth, 1.05, 0.0005);
  const Trajectory fitted = [&] {
    Trajectory out = estimate;
    out.poses = evaluated(estimate, truth, AlignmentKind::sim3).pairs.estimate;
    return out;
  }();
  const double best_m = evaluated(fitted, truth).position_m.rmse;
  for (const double sign : {-1.0, 1.0}) {
    const double small = 1e-3 * sign;
    EXPECT_GT(evaluated(moved(fitted, small, 0, 0), truth).position_m.rmse, best_m);
    EXPECT_GT(evaluated(moved(fitted, 0, small, 0), truth).position_m.rmse, best_m);
    EXPECT_GT(evaluated(moved(fitted, 0, 0, small), truth).position_m.rmse, best_m);
    EXPECT_GT(evaluated(moved(fitted, 0, 0, 0, 1.0 + small), truth).position_m.rmse, best_m);
  }
}

TEST(Evaluation, OnePercentOfScaleIsOnePercentOfDrift) {
  const Trajectory truth = test::straight(301);
  const Trajectory estimate = moved(truth, 0.0, 0.0, 0.0, 1.01);
  const TrajectoryEvaluation out = evaluated(estimate, truth);
  EXPECT_NEAR(out.drift_percent, 1.0, 1e-9);
  EXPECT_EQ(out.drift.size(), 8U);
  EXPECT_NEAR(out.rpe_m.translation_m.rmse, 0.01, 1e-9);
  EXPECT_EQ(out.rpe_m.translation_m.count, 291U);
  EXPECT_NEAR(out.rpe_s.translation_m.mean, 0.01, 1e-9);  // 1 m/s
  EXPECT_NEAR(out.end_error_m, 0.3, 1e-9);
  EXPECT_NEAR(out.way_m.back(), 30.0, 1e-9);
  EXPECT_NEAR(evaluated(estimate, truth, AlignmentKind::sim3).drift_percent, 0.0, 1e-9);
}

// RPE sees the motion, not where it is told from.
TEST(Evaluation, TurningTheWholePathLeavesRpe) {
  const Trajectory truth = test::winding(400);
  const Trajectory estimate = dead_reckoned(truth, 1.02, 0.0005);
  const TrajectoryEvaluation before = evaluated(estimate, truth);
  const TrajectoryEvaluation after = evaluated(moved(estimate, 2.0, 30.0, -7.0), truth);
  EXPECT_GT(before.rpe_m.translation_m.rmse, 1e-3);
  EXPECT_NEAR(after.rpe_m.translation_m.rmse, before.rpe_m.translation_m.rmse, 1e-12);
  EXPECT_NEAR(after.rpe_m.rotation_rad.max, before.rpe_m.rotation_rad.max, 1e-12);
  EXPECT_NEAR(after.rpe_s.translation_m.median, before.rpe_s.translation_m.median, 1e-12);
  EXPECT_NEAR(after.drift_percent, before.drift_percent, 1e-9);
  EXPECT_GT(after.position_m.rmse, before.position_m.rmse + 1.0);
}

// Heading errors have a sign: estimate less truth, to the left positive, across the wrap.
TEST(Evaluation, HeadingErrors) {
  Trajectory truth = test::straight(100);
  for (TrajectoryPose& pose : truth.poses) pose.rotation = test::turn_about_z(3.1);
  Trajectory estimate = truth;
  for (TrajectoryPose& pose : estimate.poses) pose.rotation = test::turn_about_z(3.1 + 0.1);
  const TrajectoryEvaluation out = evaluated(estimate, truth);
  EXPECT_NEAR(out.heading_rad.mean, 0.1, 1e-12);
  EXPECT_NEAR(out.heading_rad.rmse, 0.1, 1e-12);
  EXPECT_NEAR(out.rotation_rad.max, 0.1, 1e-12);
  EXPECT_NEAR(evaluated(truth, estimate).heading_rad.mean, -0.1, 1e-12);
  EXPECT_NEAR(out.rpe_m.rotation_rad.max, 0.0, 1e-12);
  EXPECT_NEAR(evaluated(estimate, truth, AlignmentKind::origin).heading_rad.max, 0.0, 1e-12);
}

// A constant yaw rate error: over d metres the heading is off by d times its rate.
TEST(Evaluation, RotationOfASegment) {
  const Trajectory truth = test::straight(200);
  const TrajectoryEvaluation out = evaluated(dead_reckoned(truth, 1.0, 0.1 * kDegree), truth);
  EXPECT_NEAR(out.rpe_m.rotation_rad.mean, 1.0 * kDegree, 1e-12);
  EXPECT_NEAR(out.rpe_m.rotation_rad.sd, 0.0, 1e-12);
}

TEST(Evaluation, StatisticsByHand) {
  const ErrorStatistics odd = statistics_of({3.0, -1.0, 4.0});
  EXPECT_EQ(odd.count, 3U);
  EXPECT_DOUBLE_EQ(odd.mean, 2.0);
  EXPECT_DOUBLE_EQ(odd.median, 3.0);
  EXPECT_DOUBLE_EQ(odd.max, 4.0);
  EXPECT_DOUBLE_EQ(odd.rmse, std::sqrt(26.0 / 3.0));
  EXPECT_DOUBLE_EQ(odd.sd, std::sqrt(14.0 / 3.0));
  EXPECT_DOUBLE_EQ(statistics_of({-5.0, 1.0, 2.0, 3.0}).median, 1.5);
  EXPECT_DOUBLE_EQ(statistics_of({-5.0, 1.0}).max, 5.0);
  EXPECT_TRUE(std::isnan(statistics_of({}).rmse));
}

// Each start with the end nearest to the length, found here by looking at all.
TEST(Evaluation, SegmentsAreThoseNearestToTheLength) {
  constexpr std::uint32_t kSeed = 66;
  std::mt19937 random(kSeed);
  std::vector<TrajectoryPose> poses;
  double x_m = 0.0;
  for (int i = 0; i < 300; ++i) {
    poses.push_back(planar_pose(0.1 * i, x_m, 0.0, 0.0));
    if (i < 100 || i > 120)
      x_m += 0.001 * static_cast<double>(random() % 200);  // stands still in between
    if (i == 200) x_m += 1.0;                              // and jumps
  }
  const Trajectory truth = test::planar(std::move(poses));
  const PosePairs pairs = test::pairs_of(truth, truth);
  const std::vector<double> way_m = path_m(pairs);
  std::vector<std::pair<std::size_t, std::size_t>> expected, found;
  for (std::size_t i = 0; i < way_m.size() && way_m[i] + 0.5 <= way_m.back(); ++i) {
    std::size_t best = 0;
    double best_off = 0.05 + 1e-12;
    for (std::size_t j = i + 1; j < way_m.size(); ++j) {
      const double off = std::abs(way_m[j] - way_m[i] - 0.5);
      if (off < best_off - 1e-12) best = j, best_off = off;
    }
    if (best > 0) expected.emplace_back(i, best);
  }
  for (const SegmentError& segment : segment_errors(pairs, way_m, 0.5)) {
    found.emplace_back(segment.first, segment.last);
    EXPECT_NEAR(segment.length, 0.5, 0.05 + 1e-12);
  }
  // Of ends equally near (the rover stands) the one that is taken may be another: lengths decide.
  ASSERT_EQ(found.size(), expected.size()) << "seed " << kSeed;
  EXPECT_GT(found.size(), 150U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].first, expected[i].first);
    EXPECT_NEAR(way_m[found[i].second], way_m[expected[i].second], 1e-9);
  }
}

// Without rotation what is left is positions: displacements along the axes, after alignment.
TEST(Evaluation, PositionsAlone) {
  Trajectory truth = test::winding(300);
  Trajectory estimate = moved(truth, 0.0, 1.0, 0.0);
  estimate.has_rotation = false;
  const TrajectoryEvaluation out = evaluated(estimate, truth);
  EXPECT_NEAR(out.position_m.rmse, 1.0, 1e-12);
  EXPECT_NEAR(out.rpe_m.translation_m.max, 0.0, 1e-12);
  EXPECT_EQ(out.rotation_rad.count, 0U);
  EXPECT_TRUE(std::isnan(out.heading_rad.rmse));
  EXPECT_EQ(out.pose_nees.count, 0U);
  Trajectory turned = moved(truth, 0.5, 1.0, 0.0);
  turned.has_rotation = false;
  EXPECT_GT(evaluated(turned, truth).rpe_m.translation_m.mean, 0.1);
  EXPECT_NEAR(evaluated(turned, truth, AlignmentKind::se2).rpe_m.translation_m.max, 0.0, 1e-9);
}

// What was not estimated has no error, and that must not look like a small one.
TEST(Evaluation, SaysHowMuchOfTheTruthIsCovered) {
  const Trajectory truth = test::straight(101);
  EXPECT_EQ(evaluated(truth, truth).covered_share, 1.0);
  Trajectory begin = truth;
  begin.poses.resize(11);
  EXPECT_NEAR(evaluated(begin, truth).covered_share, 0.1, 1e-12);
  Trajectory end = truth;
  end.poses.erase(end.poses.begin(), end.poses.begin() + 90);
  EXPECT_NEAR(evaluated(end, truth).covered_share, 0.1, 1e-12);
  Trajectory gap = truth;
  gap.poses.erase(gap.poses.begin() + 41, gap.poses.begin() + 60);
  EXPECT_NEAR(evaluated(gap, truth).covered_share, 0.8, 1e-12);
  Trajectory rows = truth;
  rows.has_time = false;
  EXPECT_TRUE(std::isnan(evaluated(rows, rows).covered_share));
}

TEST(Evaluation, OnePoseAndStandingStill) {
  const Trajectory one = test::planar({planar_pose(0, 1, 0, 0)});
  EXPECT_FALSE(evaluate(one, one, {}).ok());
  EXPECT_FALSE(evaluate(one, test::straight(10), {}).ok());
  const Trajectory still = test::planar({planar_pose(0, 0, 0, 0), planar_pose(1, 0, 0, 0)});
  EXPECT_TRUE(std::isnan(evaluated(still, still).drift_percent));
  EXPECT_EQ(evaluated(still, still).rpe_s.translation_m.rmse, 0.0);
}

TEST(Evaluation, RefusesLengthsThatAreNone) {
  const Trajectory path = test::straight(10);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double length : {0.0, -1.0, kUnknown, kInfinite}) {
    EXPECT_FALSE(evaluate(path, path, {.rpe_m = length}).ok());
    EXPECT_FALSE(evaluate(path, path, {.rpe_s = length}).ok());
    EXPECT_FALSE(evaluate(path, path, {.segments_m = {1.0, length}}).ok());
  }
}

/// Errors drawn from the covariance that is stated; `factor` times larger than that says.
Trajectory with_noise(const Trajectory& truth, std::mt19937& random, double factor) {
  Trajectory out = truth;
  for (TrajectoryPose& pose : out.poses) {
    // P = L L^T with a lower triangle that leaves no two errors independent.
    const double l[3][3] = {{0.02, 0, 0}, {-0.01, 0.03, 0}, {0.005, 0.004, 0.01}};
    double e[3] = {}, u[3];
    for (double& part : u) part = normal(random);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) e[i] += factor * l[i][j] * u[j];
    }
    const auto p = [&l](int i, int j) {
      return l[i][0] * l[j][0] + l[i][1] * l[j][1] + l[i][2] * l[j][2];
    };
    pose.x_m += e[0];
    pose.y_m += e[1];
    pose.rotation = test::turn_about_z(heading_rad(pose.rotation) + e[2]);
    out.covariances.push_back({.xx_m2 = p(0, 0),
                               .xy_m2 = p(0, 1),
                               .yy_m2 = p(1, 1),
                               .xyaw_m_rad = p(0, 2),
                               .yyaw_m_rad = p(1, 2),
                               .yawyaw_rad2 = p(2, 2)});
  }
  return out;
}

// The mean of n values of chi-square with k degrees has the standard deviation sqrt(2 k / n).
TEST(Evaluation, NeesIsTheDimensionWhereTheCovarianceIsRight) {
  constexpr std::uint32_t kSeed = 67;
  std::mt19937 random(kSeed);
  const Trajectory truth = test::winding(4000);
  const Trajectory estimate = with_noise(truth, random, 1.0);
  const TrajectoryEvaluation out = evaluated(estimate, truth);
  EXPECT_EQ(out.position_nees.count, 4000U);
  EXPECT_EQ(out.position_nees.dof, 2);
  EXPECT_NEAR(out.position_nees.mean, 2.0, 4.0 * std::sqrt(4.0 / 4000.0)) << "seed " << kSeed;
  EXPECT_NEAR(out.pose_nees.mean, 3.0, 4.0 * std::sqrt(6.0 / 4000.0)) << "seed " << kSeed;
  const double share_sd = std::sqrt(0.95 * 0.05 / 4000.0);
  EXPECT_NEAR(out.position_nees.share_inside_95, 0.95, 4.0 * share_sd);
  EXPECT_NEAR(out.pose_nees.share_inside_95, 0.95, 4.0 * share_sd);

  const TrajectoryEvaluation bold = evaluated(with_noise(truth, random, 1.5), truth);
  EXPECT_GT(bold.position_nees.mean, 4.0);
  EXPECT_LT(bold.pose_nees.share_inside_95, 0.8);

  // Of an estimate that begins at 0 with an error of its own, origin gives that to all poses.
  EXPECT_GT(evaluated(estimate, truth, AlignmentKind::origin).position_nees.mean, 4.0);

  // In another frame the covariance is still that of the frame of the estimate.
  const Trajectory elsewhere = moved(truth, 1.2, 5.0, 6.0);
  const TrajectoryEvaluation turned = evaluated(estimate, elsewhere, AlignmentKind::se2);
  EXPECT_NEAR(turned.position_nees.mean, 2.0, 0.2);
  EXPECT_NEAR(turned.pose_nees.mean, 3.0, 0.2);
}

TEST(Evaluation, CovariancesThatAreNoneAreLeftOut) {
  const Trajectory truth = test::straight(6);
  Trajectory estimate = truth;
  const PlanarCovariance sound{1, 0, 1, 0, 0, 1};
  PlanarCovariance position_only = sound;
  position_only.xyaw_m_rad = position_only.yyaw_m_rad = position_only.yawyaw_rad2 = kUnknown;
  estimate.covariances = {PlanarCovariance{0, 0, 0, 0, 0, 0},  // a start that is known exactly
                          PlanarCovariance{1, 2, 1, 0, 0, 1},  // not positive definite
                          PlanarCovariance{},
                          PlanarCovariance{1, 0, 1, 0, 2, 1},
                          position_only,
                          sound};
  for (TrajectoryPose& pose : estimate.poses) pose.x_m += 1.0;
  const TrajectoryEvaluation out = evaluated(estimate, truth);
  EXPECT_EQ(out.position_nees.count, 3U);
  EXPECT_EQ(out.position_nees.left_out, 3U);
  EXPECT_NEAR(out.position_nees.mean, 1.0, 1e-12);
  EXPECT_EQ(out.pose_nees.count, 1U);
  EXPECT_EQ(out.pose_nees.left_out, 5U);
  EXPECT_NEAR(out.pose_nees.mean, 1.0, 1e-12);
}

}  // namespace
}  // namespace lsv
