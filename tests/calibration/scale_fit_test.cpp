// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/scale_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "calibration/scale.h"

namespace lsv {
namespace {

constexpr double kPitch_m = 14e-6;

Calibration true_sensor() {
  Calibration out;
  out.pixel_pitch_x_m = out.pixel_pitch_y_m = kPitch_m;
  out.sc_x_ratio = 1.985;
  out.sc_y_ratio = 2.000;
  out.scale.emplace();
  out.scale->orientation = {.angle_rad = 0.35, .skew_rad = 0.004, .mirrored = true};
  return out;
}

/// What the true sensor sees of a travel: the inverse of eqs 3.8 and 3.9 with orientation.
ScalePoint seen(const Calibration& sensor, double x_m, double y_m) {
  const PixelScale m = pixel_scale(sensor);
  const double det = m.xx * m.yy - m.xy * m.yx;
  ScalePoint out;
  out.dx_px = (m.yy * x_m - m.xy * y_m) / det;
  out.dy_px = (m.xx * y_m - m.yx * x_m) / det;
  out.x_m = x_m;
  out.y_m = y_m;
  return out;
}

constexpr double kTravel_m = 0.05;
constexpr double kNoise_ratio = 2e-4;

/// 12 runs, three in each of four directions, with reference noise in proportion to the travel and
/// track noise of 0.01 px.
std::vector<ScaleRun> stage_runs(std::mt19937_64& random, double noise_ratio = kNoise_ratio) {
  std::normal_distribution<double> normal;
  std::vector<ScaleRun> out;
  for (int i = 0; i < 12; ++i) {
    const double heading_rad = (i % 4) * std::numbers::pi / 2.0;
    const double length_m = kTravel_m * (1.0 + 0.3 * (i / 4));
    ScalePoint point =
        seen(true_sensor(), length_m * std::cos(heading_rad), length_m * std::sin(heading_rad));
    point.sigma_m = noise_ratio * length_m;
    point.x_m += point.sigma_m * normal(random);
    point.y_m += point.sigma_m * normal(random);
    point.cov = {1e-4, 0.0, 1e-4};
    point.dx_px += 0.01 * normal(random);
    point.dy_px += 0.01 * normal(random);
    out.push_back({.name = "run" + std::to_string(i), .points = {point}});
  }
  return out;
}

TEST(ScaleFit, RecoversTheMatrixOfExactRuns) {
  std::mt19937_64 random(1);
  std::vector<ScaleRun> runs = stage_runs(random);
  for (ScaleRun& run : runs) {
    ScalePoint& point = run.points.front();
    const ScalePoint exact = seen(true_sensor(), point.x_m, point.y_m);
    point.dx_px = exact.dx_px;
    point.dy_px = exact.dy_px;
  }
  const Result<ScaleFit> fit = fit_scale(runs, kPitch_m, kPitch_m);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit.value().sc_x_ratio, 1.985, 1e-12);
  EXPECT_NEAR(fit.value().sc_y_ratio, 2.000, 1e-12);
  EXPECT_NEAR(fit.value().orientation.angle_rad, 0.35, 1e-12);
  EXPECT_NEAR(fit.value().orientation.skew_rad, 0.004, 1e-12);
  EXPECT_TRUE(fit.value().orientation.mirrored);
  EXPECT_EQ(fit.value().sigma_factor, 1.0);
  // What it found, applied, gives the travel back.
  const PixelScale scale = pixel_scale(with_scale(true_sensor(), fit.value()));
  const ScalePoint& point = runs[1].points.front();
  EXPECT_NEAR(travel(point.dx_px, point.dy_px, {}, scale).y_m, point.y_m, 1e-14);
}

// The claim of the calibration: 200 repetitions of the stage, each figure within 2 sigma in at
// least 90 % of them, and the sigmas right to 20 %.
TEST(ScaleFit, SigmasAreHonest) {
  constexpr int kRepetitions = 200;
  const double truth[] = {1.985, 2.000, 0.35, 0.004};
  double sum_squares[4] = {};
  double sum_variances[4] = {};
  int within[4] = {};
  for (int k = 0; k < kRepetitions; ++k) {
    std::mt19937_64 random(100 + static_cast<unsigned>(k));
    const Result<ScaleFit> fit = fit_scale(stage_runs(random), kPitch_m, kPitch_m);
    ASSERT_TRUE(fit) << fit.error().message;
    const ScaleFit& f = fit.value();
    const double found[] = {f.sc_x_ratio, f.sc_y_ratio, f.orientation.angle_rad,
                            f.orientation.skew_rad};
    for (std::size_t i = 0; i < 4; ++i) {
      const double error = found[i] - truth[i];
      sum_squares[i] += error * error;
      sum_variances[i] += f.cov[i][i];
      if (error * error <= 4.0 * f.cov[i][i]) ++within[i];
    }
  }
  for (int i = 0; i < 4; ++i) {
    const double ratio = std::sqrt(sum_squares[i] / sum_variances[i]);
    RecordProperty("within_2_sigma_" + std::to_string(i), within[i]);
    std::printf("figure %d: within 2 sigma %d of %d, error / sigma %.3f\n", i, within[i],
                kRepetitions, ratio);
    EXPECT_GE(within[i], 180) << i;
    EXPECT_NEAR(ratio, 1.0, 0.2) << i;
  }
}

TEST(ScaleFit, RefusesRunsAlongOneAxis) {
  std::mt19937_64 random(5);
  std::vector<ScaleRun> runs;
  for (const ScaleRun& run : stage_runs(random)) {
    if (std::abs(run.points.front().x_m) > std::abs(run.points.front().y_m)) runs.push_back(run);
  }
  const Result<ScaleFit> fit = fit_scale(runs, kPitch_m, kPitch_m);
  ASSERT_FALSE(fit);
  EXPECT_NE(fit.error().message.find("one direction only"), std::string::npos)
      << fit.error().message;
  EXPECT_NE(fit.error().message.find("right angle"), std::string::npos);
  runs.resize(2);
  EXPECT_NE(fit_scale(runs, kPitch_m, kPitch_m).error().message.find("too few"), std::string::npos);
}

TEST(ScaleFit, AStageWorseThanStatedRaisesTheSigmas) {
  std::mt19937_64 random(6);
  std::vector<ScaleRun> runs = stage_runs(random, 10.0 * kNoise_ratio);
  for (ScaleRun& run : runs) run.points.front().sigma_m /= 10.0;
  const ScaleFit fit = fit_scale(runs, kPitch_m, kPitch_m).value();
  EXPECT_NEAR(fit.sigma_factor, 10.0, 4.0);
  EXPECT_NEAR(std::sqrt(fit.cov[0][0]) / (10.0 * kNoise_ratio * 1.985 / std::sqrt(6.0)), 1.0, 0.5);
}

// One bad run stands out where it is left out, and the others do not.
TEST(ScaleFit, LeaveOneOutFindsTheBadRun) {
  std::mt19937_64 random(7);
  std::vector<ScaleRun> runs = stage_runs(random);
  runs[4].points.front().x_m *= 1.005;
  const ScaleFit fit = fit_scale(runs, kPitch_m, kPitch_m).value();
  EXPECT_GT(std::abs(fit.residuals[4].left_out_x_sigmas), 10.0);
  for (const std::size_t i : {1U, 3U, 5U, 7U})
    EXPECT_LT(std::abs(fit.residuals[i].left_out_y_sigmas), 4.0) << i;
}

// A series with an origin of its own says the same as its end points.
TEST(ScaleFit, SeriesWithTheirOwnOrigins) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  std::vector<ScaleRun> runs;
  for (int r = 0; r < 4; ++r) {
    ScaleRun run{.name = "series" + std::to_string(r), .points = {}};
    const double heading_rad = r * std::numbers::pi / 2.0;
    for (int i = 0; i <= 50; ++i) {
      const double way_m = kTravel_m * i / 50.0;
      ScalePoint point =
          seen(true_sensor(), way_m * std::cos(heading_rad), way_m * std::sin(heading_rad));
      point.x_m += 0.7 + 1e-5 * normal(random);
      point.y_m += -0.2 * r + 1e-5 * normal(random);
      point.sigma_m = 1e-5;
      run.points.push_back(point);
    }
    runs.push_back(std::move(run));
  }
  const ScaleFit fit = fit_scale(runs, kPitch_m, kPitch_m).value();
  EXPECT_NEAR(fit.sc_x_ratio, 1.985, 3.0 * std::sqrt(fit.cov[0][0]));
  EXPECT_NEAR(fit.orientation.angle_rad, 0.35, 3.0 * std::sqrt(fit.cov[2][2]));
  EXPECT_LT(std::sqrt(fit.cov[0][0]), 2e-4);
  EXPECT_EQ(fit.dof, 4 * 51 * 2 - 4 - 8);
}

TEST(ScaleFit, AChangeIsToldInSigmas) {
  std::mt19937_64 random(9);
  const ScaleFit fit = fit_scale(stage_runs(random), kPitch_m, kPitch_m).value();
  const Calibration first = with_scale(true_sensor(), fit);
  Calibration second = first;
  second.sc_y_ratio *= 1.01;
  const ScaleChange change = compare_scales(first, second);
  EXPECT_EQ(change.sigmas[0], 0.0);
  EXPECT_NEAR(change.sigmas[1], 0.01 * first.sc_y_ratio / std::sqrt(2.0 * fit.cov[1][1]), 1e-9);
  EXPECT_FALSE(change.mirror_changed);
}

}  // namespace
}  // namespace lsv
