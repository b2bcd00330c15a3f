// SPDX-License-Identifier: BSD-3-Clause
// Simulated drives on which a sensor says what is not so: what it may cost, and that it is told.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "tests/fusion/rover_trial.h"

namespace lsv {
namespace {

using test::drive;
using test::RoverTrial;

constexpr std::uint64_t kSeeds = 3;
constexpr double kPi = 3.14159265358979323846;

struct FaultErrors {
  double rmse_m = 0.0;
  double end_m = 0.0;
  double worst_yaw_rad = 0.0;
  double left_slips_share = 0.0, right_slips_share = 0.0;
  double nees_mean = 0.0;      // of x and y at the end, 2 is right
  double yaw_nees_mean = 0.0;  // at the end, 1 is right
  FusionCounters counters{};
};

double nees_xy(const sim::RoverState& truth, const NavState& s) {
  const double dx = s.x_m - truth.x_m, dy = s.y_m - truth.y_m;
  const auto& p = s.cov;
  return (dx * dx * p[1][1] - 2.0 * dx * dy * p[0][1] + dy * dy * p[0][0]) /
         (p[0][0] * p[1][1] - p[0][1] * p[0][1]);
}

FaultErrors over_seeds(const RoverTrial& trial, std::uint64_t seeds = kSeeds) {
  FaultErrors out;
  double sum_m2 = 0.0, count = 0.0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    double end_m = 0.0, nees = 0.0, yaw_nees = 0.0;
    out.counters = drive(trial, seed, [&](const sim::RoverState& truth, const NavState& state) {
      end_m = std::sqrt(test::squared_error_m2(truth, state));
      nees = nees_xy(truth, state);
      yaw_nees = std::pow(state.yaw_rad - truth.yaw_rad, 2) / state.cov[2][2];
      sum_m2 += end_m * end_m;
      out.worst_yaw_rad = std::max(out.worst_yaw_rad, std::abs(state.yaw_rad - truth.yaw_rad));
      out.left_slips_share += state.left.is_slipping;
      out.right_slips_share += state.right.is_slipping;
      ++count;
    });
    out.end_m += end_m / static_cast<double>(seeds);
    out.nees_mean += nees / static_cast<double>(seeds);
    out.yaw_nees_mean += yaw_nees / static_cast<double>(seeds);
  }
  out.rmse_m = std::sqrt(sum_m2 / count);
  out.left_slips_share /= count;
  out.right_slips_share /= count;
  return out;
}

void print(const std::string& name, const FaultErrors& e) {
  std::printf(
      "%-28s RMSE %7.2f mm, end %7.2f mm, heading %6.3f deg, NEES %6.1f (2), slips told %3.0f and "
      "%3.0f %%, grip opened %llu\n",
      name.c_str(), 1e3 * e.rmse_m, 1e3 * e.end_m, e.worst_yaw_rad * 180.0 / kPi, e.nees_mean,
      100.0 * e.left_slips_share, 100.0 * e.right_slips_share,
      static_cast<unsigned long long>(e.counters.grip_opened));
}

/// Speeds of both wheels that change every six seconds.
sim::RoverPlan uneven_plan() {
  sim::RoverPlan out{.step_s = 0.05, .steps = 2400};
  for (int i = 0; i < 20; ++i)
    out.commands.push_back({6.0, 0.3 + 0.05 * (i * 7 % 9), 0.3 + 0.05 * (i * 5 % 8)});
  return out;
}

struct WheelFault {
  std::string name;
  sim::RoverPlan plan;
  std::function<void(double, WheelSample&)> wheels_become;
  double least_told_share;  // of the drive, of the left wheel; 0: not asked
};

std::vector<WheelFault> wheel_faults() {
  const auto frozen_from_30_s = [last = WheelSample{}](double time_s, WheelSample& wheels) mutable {
    if (time_s < 30.0) last = wheels;
    wheels = {wheels.stamp, last.left_rad_s, last.right_rad_s};
  };
  const auto still = [random = std::mt19937_64(3),
                      noise = std::normal_distribution<double>(0.0, 0.017)](
                         double, WheelSample& wheels) mutable {
    wheels.left_rad_s = noise(random);
    wheels.right_rad_s = noise(random);
  };
  const sim::RoverPlan sand = test::sand_plan();
  sim::RoverPlan sliding = sand;
  sliding.patches.clear();
  sliding.commands = {{1e6, 0.2, 0.2}};
  return {{"left reads 0", sand, [](double, WheelSample& w) { w.left_rad_s = 0.0; }, 0.99},
          {"left reads 0 from 40 s", sand,
           [](double time_s, WheelSample& w) { w.left_rad_s *= time_s < 40.0; }, 0.66},
          {"both read 0", sand, [](double, WheelSample& w) { w.left_rad_s = w.right_rad_s = 0.0; },
           0.99},
          {"both read noise", sand, still, 0.99},
          {"braked, sliding at 20 mm/s", sliding, still, 0.99},
          {"frozen from 30 s", uneven_plan(), frozen_from_30_s, 0.0},
          {"both read 0 from 20 s", uneven_plan(),
           [](double time_s, WheelSample& w) {
             if (time_s >= 20.0) w.left_rad_s = w.right_rad_s = 0.0;
           },
           0.82},
          {"wrong sign", uneven_plan(),
           [](double, WheelSample& w) {
             w.left_rad_s *= -1.0;
             w.right_rad_s *= -1.0;
           },
           0.99},
          {"counts that overflow", uneven_plan(),
           [random = std::mt19937_64(7)](double, WheelSample& w) mutable {
             w.left_rad_s = 1e5 * (static_cast<double>(random() % 3) - 1.0);
             w.right_rad_s = 1e5 * (static_cast<double>(random() % 3) - 1.0);
           },
           0.99},
          {"0 every other time", uneven_plan(),
           [is_odd = false](double, WheelSample& w) mutable {
             is_odd = !is_odd;
             if (is_odd) w.left_rad_s = w.right_rad_s = 0.0;
           },
           0.0}};
}

// Two LSV sensors tell all of the motion: whatever encoders say must not spoil it.
TEST(RoverFaults, WheelsThatReadWrongCostTwoSensorsNothing) {
  for (const WheelFault& fault : wheel_faults()) {
    RoverTrial trial{.plan = fault.plan, .has_wheels = false};
    const FaultErrors optics = over_seeds(trial);
    trial.has_wheels = true;
    trial.wheels_become = fault.wheels_become;
    const FaultErrors fused = over_seeds(trial);
    print(fault.name, fused);
    std::printf("%-28s RMSE %7.2f mm, end %7.2f mm\n", "  LSV alone", 1e3 * optics.rmse_m,
                1e3 * optics.end_m);
    EXPECT_LE(fused.rmse_m, 1.1 * optics.rmse_m + 1e-3) << fault.name;
    EXPECT_LE(fused.end_m, 1.1 * optics.end_m + 2e-3) << fault.name;
    EXPECT_LE(fused.nees_mean, 5.0) << fault.name;
    EXPECT_GE(fused.left_slips_share, fault.least_told_share) << fault.name;
    EXPECT_GE(fused.counters.grip_opened, 1U) << fault.name;
  }
}

// --- one sensor

struct OneSensorDrive {
  std::string name;
  sim::RoverPlan plan;
};

std::vector<OneSensorDrive> one_sensor_drives() {
  sim::RoverPlan stop_and_go = test::sand_plan();
  stop_and_go.commands.clear();
  for (int i = 0; i < 20; ++i) {
    stop_and_go.commands.push_back({3.0, 0.55, 0.55});
    stop_and_go.commands.push_back({3.0, 0.0, 0.0});
  }
  sim::RoverPlan wandering{.step_s = 0.05, .steps = 2400};
  wandering.random = sim::RandomDrive{.efficiency_sigma_ratio = 0.05};
  return {{"sand", test::sand_plan()},
          {"uneven speeds", uneven_plan()},
          {"stop and go in sand", stop_and_go},
          {"wandering, with side slip", wandering}};
}

// One sensor cannot tell turning from side slip. Alone it takes the side slip for zero, which on
// all of these drives but the last it is; wheels must not turn a change of grip into a turn.
TEST(RoverFaults, WheelsDoOneSensorNoHarm) {
  constexpr std::uint64_t kManySeeds = 8;
  for (const OneSensorDrive& one : one_sensor_drives()) {
    RoverTrial trial{.plan = one.plan, .has_wheels = false};
    trial.lsv.pop_back();
    const FaultErrors alone = over_seeds(trial, kManySeeds);
    trial.has_wheels = true;
    const FaultErrors fused = over_seeds(trial, kManySeeds);
    print(one.name + ", one LSV alone", alone);
    print(one.name + ", with wheels", fused);
    EXPECT_LE(fused.rmse_m, 2.0 * alone.rmse_m) << one.name;
    EXPECT_LE(fused.worst_yaw_rad, 2.0 * alone.worst_yaw_rad) << one.name;
    EXPECT_LE(fused.yaw_nees_mean, 2.5) << one.name;
  }
}

// From 40 s on the second sensor is dark.
TEST(RoverFaults, OneOfTwoSensorsGoesAway) {
  RoverTrial trial;
  trial.lsv[1].lost = {{40.0, 1e6}};
  const FaultErrors fused = over_seeds(trial, 8);
  print("second LSV dark from 40 s", fused);
  EXPECT_LE(fused.rmse_m, 0.05);
  EXPECT_LE(fused.worst_yaw_rad, 4.0 * kPi / 180.0);
  EXPECT_LE(fused.nees_mean, 6.0);
}

// --- gyro

// A bias that nobody mentions is still likely.
TEST(RoverFaults, AGyroBiasIsFoundThoughTheConfigurationDoesNotMentionIt) {
  RoverTrial trial;
  trial.imu = sim::ImuConfig{.gyro_noise_rad_s = 0.002, .gyro_bias_rad_s = 0.02};
  trial.adjust = [](FusionConfig& config) { config.gyro = GyroConfig{.noise_rad_s = 0.002}; };
  const FaultErrors two = over_seeds(trial);
  print("gyro bias of 1.1 deg/s", two);
  EXPECT_LE(two.rmse_m, 0.010);
  EXPECT_LE(two.yaw_nees_mean, 3.0);
  EXPECT_EQ(two.counters.gyro_refused, 0U);
}

// --- scale

// The second sensor reads too much, and the noise is so small that the sigmas do not cover it.
TEST(RoverFaults, AScaleMismatchThrowsNoGoodSensorAway) {
  for (const double ratio : {1.001, 1.005, 1.01}) {
    RoverTrial trial;
    for (sim::RoverLsvConfig& sensor : trial.lsv) sensor.noise_m_s = 1e-5;
    trial.lsv_becomes = [&](std::size_t sensor, LsvSample& sample) {
      if (sensor == 0) return;
      sample.vx_m_s *= ratio;
      sample.vy_m_s *= ratio;
    };
    const auto with = [&](double sigma_scale_ratio) {
      trial.adjust = [=](FusionConfig& config) {
        for (LsvConfig& sensor : config.lsv) sensor.sigma_scale_ratio = sigma_scale_ratio;
      };
      return over_seeds(trial);
    };
    // By default half a percent passes; who expects more has to say so.
    const FaultErrors ignored = with(0.0),
                      known = with(ratio < 1.006 ? LsvConfig{}.sigma_scale_ratio : 0.005);
    const auto refused = [](const FaultErrors& errors) {
      return errors.counters.lsv_refused_by_parity + errors.counters.lsv_refused_by_innovation;
    };
    std::printf("second sensor x %.3f, refused %llu without and %llu with sigma_scale_ratio\n",
                ratio, static_cast<unsigned long long>(refused(ignored)),
                static_cast<unsigned long long>(refused(known)));
    print("without", ignored);
    print("with", known);
    EXPECT_LE(refused(known), 2U) << ratio;
    EXPECT_LE(known.rmse_m, 0.030) << ratio;
    EXPECT_TRUE(ratio < 1.002 || refused(ignored) > 500) << ratio;
  }
}

}  // namespace
}  // namespace lsv
