// SPDX-License-Identifier: BSD-3-Clause
// The navigator on simulated drives: what it must reach, and that its covariance is honest.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>

#include "fusion/navigator.h"
#include "sim/rover_drive.h"
#include "sim/rover_sensors.h"

namespace lsv {
namespace {

constexpr double kStart_rad = 40.0 * 3.14159265358979323846 / 180.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The sand crossing: 120 s, about 5.4 m, a band of sand at 2 < y < 3 with ramps of 1 s.
sim::RoverPlan sand_plan() {
  return {.start_yaw_rad = kStart_rad,
          .step_s = 0.05,
          .steps = 2400,
          .commands = {{1e6, 0.55, 0.55}},
          .patches = {{-kInfinity, kInfinity, 2.0, 3.0, 0.5}},
          .ramp_s = 1.0};
}

/// The source's places (p right, q forward): (-0.25, 0.20) and (0.30, 0.35).
std::vector<sim::RoverLsvConfig> two_sensors() {
  return {{.place = {.x_m = 0.20, .y_m = 0.25}, .noise_m_s = 7e-4},
          {.place = {.x_m = 0.35, .y_m = -0.30}, .noise_m_s = 7e-4}};
}

struct Trial {
  sim::RoverPlan plan = sand_plan();
  std::vector<sim::RoverLsvConfig> lsv = two_sensors();
  bool has_wheels = true;
  std::optional<sim::ImuConfig> imu{};
  /// Changes to what the navigator believes.
  std::function<void(FusionConfig&)> adjust = [](FusionConfig&) {};
  double lsv_sigma_factor = 1.0;  // that it is told
};

FusionConfig config_of(const Trial& trial) {
  FusionConfig out;
  if (trial.has_wheels) out.wheels = WheelConfig{0.1, 0.8, 0.017, {}};
  for (const sim::RoverLsvConfig& sensor : trial.lsv)
    out.lsv.push_back({"", sensor.place.x_m, sensor.place.y_m, sensor.place.yaw_rad,
                       sensor.noise_m_s * trial.lsv_sigma_factor});
  if (trial.imu) out.gyro = GyroConfig{trial.imu->gyro_noise_rad_s, 0.01};
  out.start.yaw_rad = trial.plan.start_yaw_rad;
  trial.adjust(out);
  return out;
}

using Each = std::function<void(const sim::RoverState&, const NavState&)>;

/// Every sample in its turn; `each` sees truth and estimate at every stamp.
FusionCounters drive(Trial trial, std::uint64_t seed, const Each& each) {
  trial.plan.seed = seed;
  Navigator nav = Navigator::create(config_of(trial)).value();
  const std::vector<sim::RoverState> truth = sim::drive_rover(trial.plan);
  std::vector<std::vector<sim::RoverLsvReading>> lsv;
  for (std::size_t i = 0; i < trial.lsv.size(); ++i)
    lsv.push_back(sim::read_lsv(truth, trial.lsv[i], seed, static_cast<int>(i)));
  const auto wheels = sim::read_encoders(truth, {.noise_rad_s = 0.017}, seed);
  const auto imu = sim::read_imu(truth, trial.imu.value_or(sim::ImuConfig{}), seed);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Stamp stamp{truth[k].time_ns};
    for (std::size_t i = 0; i < lsv.size(); ++i) {
      const sim::RoverLsvReading& r = lsv[i][k];
      if (!r.is_lost) nav.add(i, {.stamp = stamp, .vx_m_s = r.vx_m_s, .vy_m_s = r.vy_m_s});
    }
    if (trial.imu) nav.add(GyroSample{stamp, imu[k].wz_rad_s});
    if (trial.has_wheels) nav.add(WheelSample{stamp, wheels[k].left_rad_s, wheels[k].right_rad_s});
    each(truth[k], nav.state_at(stamp));
  }
  return nav.counters();
}

double squared_error_m2(const sim::RoverState& truth, const NavState& state) {
  return std::pow(state.x_m - truth.x_m, 2) + std::pow(state.y_m - truth.y_m, 2);
}

/// Root mean squares over one drive.
struct DriveErrors {
  double position_m = 0.0;
  double vx_m_s = 0.0;
  double wz_rad_s = 0.0;
};

struct Result20 {
  std::array<DriveErrors, 20> seed{};
  double rmse_m = 0.0;  // over all stamps of all seeds
  double worst_rmse_m = 0.0;
  double worst_end_m = 0.0;
  double worst_yaw_rad = 0.0;
  FusionCounters counters{};  // of the last
};

Result20 over_20_seeds(
    const Trial& trial, const Each& also = [](const auto&, const auto&) {}) {
  Result20 out;
  double all = 0.0;
  for (std::size_t i = 0; i < out.seed.size(); ++i) {
    double end = 0.0, sum = 0.0, vx_sum = 0.0, wz_sum = 0.0;
    int count = 0;
    out.counters = drive(trial, i + 1, [&](const sim::RoverState& truth, const NavState& state) {
      end = squared_error_m2(truth, state);
      sum += end;
      vx_sum += std::pow(state.vx_m_s - truth.vx_m_s, 2);
      wz_sum += std::pow(state.wz_rad_s - truth.wz_rad_s, 2);
      ++count;
      out.worst_yaw_rad = std::max(out.worst_yaw_rad, std::abs(state.yaw_rad - truth.yaw_rad));
      also(truth, state);
    });
    out.seed[i] = {std::sqrt(sum / count), std::sqrt(vx_sum / count), std::sqrt(wz_sum / count)};
    all += sum / count / static_cast<double>(out.seed.size());
    out.worst_rmse_m = std::max(out.worst_rmse_m, out.seed[i].position_m);
    out.worst_end_m = std::max(out.worst_end_m, std::sqrt(end));
  }
  out.rmse_m = std::sqrt(all);
  return out;
}

/// Encoders tell of changes, and hardly of the mean: how a wheel grips has to be found out. So they
/// make the speeds better on every drive, and the position, which is their sum, neither better nor
/// worse: on 1000 seeds the difference has a mean of -0.001 mm and a standard deviation of 0.03 mm.
void expect_never_worse(const Result20& fused, const Result20& optics) {
  constexpr double kChance_m = 1e-4;
  int farther = 0;
  std::printf(
      "seed: RMSE fused and with LSV alone of position in mm (difference), vx in mm/s, wz in "
      "mrad/s\n");
  for (std::size_t i = 0; i < fused.seed.size(); ++i) {
    const DriveErrors &with = fused.seed[i], &without = optics.seed[i];
    std::printf("%4zu  %6.3f %6.3f (%+.3f)  %.4f %.4f  %.3f %.3f\n", i + 1, 1e3 * with.position_m,
                1e3 * without.position_m, 1e3 * (with.position_m - without.position_m),
                1e3 * with.vx_m_s, 1e3 * without.vx_m_s, 1e3 * with.wz_rad_s,
                1e3 * without.wz_rad_s);
    farther += with.position_m > without.position_m;
    EXPECT_LE(with.position_m, without.position_m + kChance_m) << "seed " << i + 1;
    EXPECT_LT(with.vx_m_s, without.vx_m_s) << "seed " << i + 1;
    EXPECT_LT(with.wz_rad_s, without.wz_rad_s) << "seed " << i + 1;
  }
  std::printf("the position is farther off with encoders on %d of 20 seeds\n", farther);
  EXPECT_LE(fused.rmse_m, optics.rmse_m);
}

TEST(RoverFusion, CrossesSandWithinTenMillimetres) {
  long slipping = 0, told = 0, gripping = 0, false_alarms = 0;
  const auto count = [&](double efficiency, const WheelGrip& grip) {
    if (efficiency < 0.85) {
      ++slipping;
      told += grip.is_slipping;
    } else {
      ++gripping;
      false_alarms += grip.is_slipping;
    }
  };
  const Result20 fused =
      over_20_seeds({}, [&](const sim::RoverState& truth, const NavState& state) {
        count(truth.left_efficiency_ratio, state.left);
        count(truth.right_efficiency_ratio, state.right);
      });
  const Result20 optics = over_20_seeds({.has_wheels = false});
  const Result20 encoders = over_20_seeds({.lsv = {}});
  const double told_percent = 100.0 * static_cast<double>(told) / static_cast<double>(slipping);
  const double false_percent =
      100.0 * static_cast<double>(false_alarms) / static_cast<double>(gripping);
  std::printf(
      "position RMSE over seeds 1 to 20: fused %.2f mm (worst %.2f), LSV alone %.2f mm, encoders "
      "alone %.0f mm\n",
      1e3 * fused.rmse_m, 1e3 * fused.worst_rmse_m, 1e3 * optics.rmse_m, 1e3 * encoders.rmse_m);
  std::printf("slip told on %.2f %% of the slipping samples, false on %.2f %%\n", told_percent,
              false_percent);
  EXPECT_LE(fused.rmse_m, 0.010);
  expect_never_worse(fused, optics);
  EXPECT_GT(encoders.rmse_m, 0.3);
  EXPECT_GE(told_percent, 99.0);
  EXPECT_LE(false_percent, 0.5);
}

Trial with_outliers() {
  Trial trial;
  for (sim::RoverLsvConfig& sensor : trial.lsv) {
    sensor.outlier_share = 0.02;
    sensor.outlier_m_s = 0.3;
  }
  return trial;
}

TEST(RoverFusion, GrossOutliersCostLittle) {
  const Result20 gated = over_20_seeds(with_outliers());
  std::printf(
      "2 %% outliers: %.2f mm (worst seed %.2f); refused by parity %llu, by innovation %llu\n",
      1e3 * gated.rmse_m, 1e3 * gated.worst_rmse_m,
      static_cast<unsigned long long>(gated.counters.lsv_refused_by_parity),
      static_cast<unsigned long long>(gated.counters.lsv_refused_by_innovation));
  EXPECT_LE(gated.rmse_m, 0.008);
  EXPECT_GT(gated.counters.lsv_refused_by_parity, 60U);
}

/// Gates measure in sigmas, and gains know only their ratios: all sigmas 20 times larger and a
/// limit that is exceeded with 1e-300 open every gate and leave the weights as they are.
Trial without_gates(Trial trial) {
  constexpr double kLarger = 20.0;
  trial.lsv_sigma_factor = kLarger;
  trial.adjust = [](FusionConfig& config) {
    config.gate_probability = 1e-300;
    config.wheels->noise_rad_s *= kLarger;
    config.motion.vx_walk_m_s *= kLarger;
    config.motion.wz_walk_rad_s *= kLarger;
    config.motion.vy_sigma_m_s *= kLarger;
    config.motion.efficiency_sigma_ratio *= kLarger;
  };
  return trial;
}

TEST(RoverFusion, WithoutGatesGrossOutliersCostDecimetres) {
  const Result20 clean = over_20_seeds(without_gates({}));
  const Result20 dirty = over_20_seeds(without_gates(with_outliers()));
  double mean_m = 0.0;
  for (const DriveErrors& errors : dirty.seed) mean_m += errors.position_m / 20.0;
  std::printf(
      "without gates: %.2f mm, with 2 %% outliers %.0f mm (mean of the seeds %.0f, worst %.0f)\n",
      1e3 * clean.rmse_m, 1e3 * dirty.rmse_m, 1e3 * mean_m, 1e3 * dirty.worst_rmse_m);
  EXPECT_EQ(dirty.counters.lsv_refused_by_parity + dirty.counters.lsv_refused_by_innovation, 0U);
  EXPECT_EQ(dirty.counters.velocity_steps + dirty.counters.lsv_streaks_ended, 0U);
  EXPECT_LE(clean.rmse_m, 0.010);  // it is the gates and not the weights that are missed
  EXPECT_GT(dirty.rmse_m, 0.1);
}

TEST(RoverFusion, AStepOfVelocityLocksNothingOut) {
  Trial trial;
  trial.plan.patches.clear();
  trial.plan.commands = {{40.0, 0.55, 0.55}, {40.0, 0.25, 0.35}, {1e6, 0.6, 0.5}};
  const Result20 result = over_20_seeds(trial);
  std::printf("steps of velocity: %.2f mm, %llu steps, %llu refused\n", 1e3 * result.rmse_m,
              static_cast<unsigned long long>(result.counters.velocity_steps),
              static_cast<unsigned long long>(result.counters.lsv_refused_by_innovation +
                                              result.counters.lsv_refused_by_parity));
  EXPECT_LE(result.rmse_m, 0.008);
  EXPECT_LE(result.counters.lsv_refused_by_innovation + result.counters.lsv_refused_by_parity, 2U);
}

TEST(RoverFusion, SideSlipIsSeenByTwoSensors) {
  Trial trial;
  trial.plan.patches.clear();
  trial.plan.steps = 1091;
  trial.plan.side_slips = {{15.0, 35.0, 0.003}};
  const Result20 two = over_20_seeds(trial);
  std::printf(
      "60 mm of side slip on 3 m: %.2f mm RMSE, worst end %.2f mm, worst heading %.3f deg\n",
      1e3 * two.rmse_m, 1e3 * two.worst_end_m, two.worst_yaw_rad * 180.0 / 3.14159265358979);
  EXPECT_LE(two.worst_end_m, 0.015);
  EXPECT_LE(two.worst_yaw_rad, 0.5 * 3.14159265358979 / 180.0);
}

TEST(RoverFusion, OpticsLostInSandAreBridgedHonestly) {
  Trial trial;
  for (sim::RoverLsvConfig& sensor : trial.lsv) sensor.lost = {{70.0, 80.0}};
  int outside = 0, seeds_told_late = 0, recovered_late = 0;
  double worst_m = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    double told_s = kInfinity, ok_s = kInfinity;
    drive(trial, seed, [&](const sim::RoverState& truth, const NavState& state) {
      const double time_s = static_cast<double>(truth.time_ns) * 1e-9;
      if (time_s >= 70.0 && state.status == NavStatus::optical_lost)
        told_s = std::min(told_s, time_s);
      if (time_s >= 80.0 && state.status == NavStatus::ok) ok_s = std::min(ok_s, time_s);
      if (std::abs(time_s - 79.95) > 1e-6) return;
      const double dx = state.x_m - truth.x_m, dy = state.y_m - truth.y_m;
      const auto& p = state.cov;
      const double det = p[0][0] * p[1][1] - p[0][1] * p[0][1];
      const double nees = (dx * dx * p[1][1] - 2.0 * dx * dy * p[0][1] + dy * dy * p[0][0]) / det;
      outside += nees > 5.991;
      worst_m = std::max(worst_m, std::hypot(dx, dy));
    });
    seeds_told_late += told_s > 70.1 + 1e-9;
    recovered_late += ok_s > 80.0 + 20 * 0.05;
  }
  std::printf(
      "10 s without optics in sand: outside the 95 %% ellipse in %d of 20, worst %.1f mm; told "
      "late in %d, recovered late in %d\n",
      outside, 1e3 * worst_m, seeds_told_late, recovered_late);
  EXPECT_LE(outside, 3);
  EXPECT_EQ(seeds_told_late, 0);
  EXPECT_EQ(recovered_late, 0);
}

// --- consistency

using Vector6 = std::array<double, 6>;

/// Solves by elimination: an oracle of its own.
double nees6(const Vector6& error, const NavCovariance& cov) {
  auto a = cov;
  Vector6 b = error;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = i + 1; j < 6; ++j) {
      const double factor = a[j][i] / a[i][i];
      for (std::size_t k = i; k < 6; ++k) a[j][k] -= factor * a[i][k];
      b[j] -= factor * b[i];
    }
  }
  Vector6 x{};
  double out = 0.0;
  for (std::size_t i = 6; i-- > 0;) {
    double sum = b[i];
    for (std::size_t k = i + 1; k < 6; ++k) sum -= a[i][k] * x[k];
    x[i] = sum / a[i][i];
    out += x[i] * error[i];
  }
  return out;
}

struct Consistency {
  double nees_inside =
      0.0;  // share of the spaced times whose mean over 50 runs is in the 95 % band
  double nis_inside = 0.0;
  double nees_mean = 0.0;
  double nis_mean = 0.0;
};

constexpr int kRuns = 50;

/// 50 drives whose speeds wander as the filter believes; means over the drives at times 2 s apart.
Consistency consistency(const std::function<void(FusionConfig&)>& adjust, double sigma_factor,
                        std::uint64_t first_seed = 1) {
  constexpr int kSteps = 1600, kSpacing = 40;
  std::array<double, kSteps / kSpacing> nees{}, nis{};
  Trial trial;
  trial.plan = {
      .step_s = 0.05, .steps = kSteps, .random = sim::RandomDrive{.efficiency_sigma_ratio = 0.05}};
  trial.imu = sim::ImuConfig{.gyro_noise_rad_s = 0.002, .gyro_bias_rad_s = 0.005};
  trial.lsv_sigma_factor = sigma_factor;
  trial.adjust = [&](FusionConfig& config) {
    config.motion.efficiency_sigma_ratio = 0.05;
    config.start = {.sigma_m = 1e-6, .sigma_yaw_rad = 1e-6};
    adjust(config);
  };
  std::mt19937_64 random(first_seed);
  std::normal_distribution<double> bias_rad_s(0.0, 0.01);
  for (std::uint64_t seed = first_seed; seed < first_seed + kRuns; ++seed) {
    trial.imu->gyro_bias_rad_s = bias_rad_s(random);
    int k = 0;
    drive(trial, seed, [&](const sim::RoverState& truth, const NavState& s) {
      if (++k % kSpacing != 0) return;
      const auto at = static_cast<std::size_t>(k / kSpacing - 1);
      if (at >= nees.size()) return;
      nees[at] +=
          nees6({s.x_m - truth.x_m, s.y_m - truth.y_m, s.yaw_rad - truth.yaw_rad,
                 s.vx_m_s - truth.vx_m_s, s.vy_m_s - truth.vy_m_s, s.wz_rad_s - truth.wz_rad_s},
                s.cov) /
          kRuns;
      nis[at] += s.lsv.nis / kRuns;
    });
  }
  Consistency out;
  const double times = static_cast<double>(nees.size());
  for (std::size_t i = 0; i < nees.size(); ++i) {
    out.nees_mean += nees[i] / times;
    out.nis_mean += nis[i] / times;
    // Bounds of the mean of 50: ../docs/fusion.md
    out.nees_inside += (nees[i] > 5.078 && nees[i] < 6.997) / times;
    out.nis_inside += (nis[i] > 3.255 && nis[i] < 4.821) / times;
  }
  return out;
}

TEST(RoverFusion, TheCovarianceIsHonest) {
  const auto show = [](const char* name, const Consistency& c) {
    std::printf("%-12s NEES %.2f (6), %.0f %% of the times in the band; NIS %.2f (4), %.0f %%\n",
                name, c.nees_mean, 100.0 * c.nees_inside, c.nis_mean, 100.0 * c.nis_inside);
  };
  const auto as_it_is = [](FusionConfig&) {};
  // Errors of the pose last for the whole drive, so that one set of 50 is in the band or out of it
  // at many times at once: four sets.
  Consistency right;
  for (std::uint64_t set = 0; set < 4; ++set) {
    const Consistency one = consistency(as_it_is, 1.0, 1 + kRuns * set);
    show("as it is", one);
    right.nees_inside += one.nees_inside / 4.0;
    right.nis_inside += one.nis_inside / 4.0;
    right.nees_mean += one.nees_mean / 4.0;
    right.nis_mean += one.nis_mean / 4.0;
  }
  const Consistency small_q = consistency(
      [](FusionConfig& config) {
        config.motion.vx_walk_m_s /= std::sqrt(10.0);
        config.motion.wz_walk_rad_s /= std::sqrt(10.0);
        config.motion.vy_sigma_m_s /= std::sqrt(10.0);
      },
      1.0);
  const Consistency small_r = consistency(as_it_is, 0.5), large_r = consistency(as_it_is, 2.0);
  show("of all", right);
  show("Q / 10", small_q);
  show("R / 4", small_r);
  show("R x 4", large_r);
  EXPECT_GE(right.nees_inside, 0.9);
  EXPECT_GE(right.nis_inside, 0.9);
  for (const Consistency& wrong : {small_q, small_r, large_r}) {
    EXPECT_LT(wrong.nees_inside, 0.5);
    EXPECT_LT(wrong.nis_inside, 0.5);
  }
}

}  // namespace
}  // namespace lsv
