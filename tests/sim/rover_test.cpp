// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/rover_drive.h"
#include "sim/rover_sensors.h"

namespace lsv::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Appendix D of the Masuku thesis: 299 steps of 0.5 s from 40 degrees, sand at 2 < y < 3.
RoverPlan appendix_d() {
  return {.start_yaw_rad = 40.0 / kDegrees,
          .step_s = 0.5,
          .steps = 299,
          .integrator = RoverIntegrator::euler,
          .commands = {{1e6, 0.55, 0.55}},
          .patches = {{-kInfinity, kInfinity, 2.0, 3.0, 0.5}}};
}

TEST(RoverDrive, AppendixDEndsWhereItsCodeEnds) {
  const std::vector<RoverState> states = drive_rover(appendix_d());
  EXPECT_NEAR(states.back().x_m, 4.901692, 1e-6);
  EXPECT_NEAR(states.back().y_m, 4.982738, 1e-6);
  EXPECT_NEAR(states.back().yaw_rad * kDegrees, 40.984771, 1e-6);
  EXPECT_EQ(states.back().time_ns, 149'500'000'000);

  RoverPlan encoders = appendix_d();
  encoders.patches.clear();
  const RoverState believed = drive_rover(encoders).back();
  EXPECT_NEAR(believed.x_m, 6.298800, 1e-6);
  EXPECT_NEAR(believed.y_m, 5.285321, 1e-6);
}

TEST(RoverDrive, AppendixDHasItsThreeSpeeds) {
  int hard = 0, one = 0, both = 0;
  for (const RoverState& state : drive_rover(appendix_d())) {
    const int in_sand = (state.left_efficiency_ratio < 1.0) + (state.right_efficiency_ratio < 1.0);
    const double expected_m_s[] = {0.055, 0.04125, 0.0275};
    EXPECT_NEAR(state.vx_m_s, expected_m_s[in_sand], 1e-15);
    EXPECT_NEAR(std::abs(state.wz_rad_s), in_sand == 1 ? 0.034375 : 0.0, 1e-15);
    ++(in_sand == 0 ? hard : in_sand == 1 ? one : both);
  }
  EXPECT_GT(hard, 100);
  EXPECT_GT(one, 10);
  EXPECT_GT(both, 40);
}

TEST(RoverDrive, UnequalWheelsDriveACircle) {
  const double radius_m = 1.3, wz_rad_s = 0.2, track_m = 0.8, wheel_m = 0.1;
  const double left = (radius_m - track_m / 2.0) * wz_rad_s / wheel_m;
  const double right = (radius_m + track_m / 2.0) * wz_rad_s / wheel_m;
  const RoverPlan plan{.step_s = 0.1, .steps = 100, .commands = {{1e6, left, right}}};
  for (const RoverState& state : drive_rover(plan)) {
    const double turn = wz_rad_s * static_cast<double>(state.time_ns) * 1e-9;
    EXPECT_NEAR(state.x_m, radius_m * std::sin(turn), 1e-12);
    EXPECT_NEAR(state.y_m, radius_m * (1.0 - std::cos(turn)), 1e-12);
    EXPECT_NEAR(state.yaw_rad, turn, 1e-12);
  }
}

TEST(RoverDrive, TheWheelInTheSandIsTheSideThatStaysBehind) {
  RoverPlan plan{.step_s = 0.05,
                 .steps = 20,
                 .commands = {{1e6, 0.55, 0.55}},
                 .patches = {{-1.0, 100.0, 0.2, 0.6, 0.5}}};  // under the left wheel
  EXPECT_GT(drive_rover(plan).back().wz_rad_s, 0.0);
  plan.patches[0].bottom_m = -0.6;
  plan.patches[0].top_m = -0.2;
  EXPECT_LT(drive_rover(plan).back().wz_rad_s, 0.0);
}

TEST(RoverDrive, GripFallsAsFastAsTheRampSays) {
  RoverPlan plan{.step_s = 0.1,
                 .steps = 40,
                 .commands = {{1e6, 0.55, 0.55}},
                 .patches = {{0.052, 100.0, -9.0, 9.0, 0.5}},
                 .ramp_s = 1.0};
  const std::vector<RoverState> states = drive_rover(plan);
  // The first step in the sand is that to 1 s.
  EXPECT_EQ(states[9].left_efficiency_ratio, 1.0);
  EXPECT_NEAR(states[14].left_efficiency_ratio, 0.75, 1e-9);
  EXPECT_NEAR(states[19].left_efficiency_ratio, 0.5, 1e-9);
  EXPECT_NEAR(states[40].left_efficiency_ratio, 0.5, 1e-9);
}

TEST(RoverDrive, SideSlipIsToTheLeft) {
  const RoverPlan plan{.start_yaw_rad = std::numbers::pi / 2.0,
                       .step_s = 0.1,
                       .steps = 100,
                       .side_slips = {{2.0, 4.0, 0.01}}};
  const RoverState end = drive_rover(plan).back();
  EXPECT_NEAR(end.x_m, -0.02, 1e-9);
  EXPECT_NEAR(end.y_m, 0.0, 1e-12);
}

TEST(RoverDrive, SoilsAreThoseOfTheSource) {
  EXPECT_EQ(soil_efficiency("A"), 1.0);
  EXPECT_EQ(soil_efficiency("E"), 0.4);
  EXPECT_EQ(soil_efficiency("F"), std::nullopt);
}

/// Sample variance over its expectation; chance stays within 4 root(2 / n).
void expect_variance(double sum_squares, int n, double expected) {
  EXPECT_NEAR(sum_squares / n / expected, 1.0, 4.0 * std::sqrt(2.0 / n)) << "seed 1";
}

TEST(RoverDrive, RandomSpeedsWanderAsTheyAreSaidTo) {
  RoverPlan plan{.step_s = 0.05, .steps = 40'000, .random = RandomDrive{}};
  const std::vector<RoverState> states = drive_rover(plan);
  double vx = 0.0, wz = 0.0, vy = 0.0;
  for (std::size_t k = 1; k < states.size(); ++k) {
    vx += std::pow(states[k].vx_m_s - states[k - 1].vx_m_s, 2);
    wz += std::pow(states[k].wz_rad_s - states[k - 1].wz_rad_s, 2);
    vy += states[k].vy_m_s * states[k].vy_m_s;
  }
  expect_variance(vx, plan.steps, 1e-4 * 0.05);
  expect_variance(wz, plan.steps, 4e-4 * 0.05);
  // 2000 s hold about 100 independent values.
  EXPECT_NEAR(vy / plan.steps / 9e-6, 1.0, 0.6);
  for (const RoverState& s : states) {
    EXPECT_NEAR(
        s.vx_m_s,
        0.05 * (s.left_rad_s * s.left_efficiency_ratio + s.right_rad_s * s.right_efficiency_ratio),
        1e-12);
  }
  EXPECT_EQ(drive_rover(plan).back().x_m, states.back().x_m);
}

TEST(RoverSensors, TicksAddUpToTheAngle) {
  const std::vector<RoverState> states =
      drive_rover({.step_s = 0.05, .steps = 1000, .commands = {{1e6, 0.55, -0.31}}});
  const double tick_rad = 2.0 * std::numbers::pi / 360.0;
  double left = 0.0, right = 0.0;
  for (const EncoderReading& r : read_encoders(states, {.ticks_per_turn = 360.0}, 1)) {
    left += r.left_rad_s * 0.05;
    right += r.right_rad_s * 0.05;
    EXPECT_NEAR(left / tick_rad, std::round(left / tick_rad), 1e-6);
    const double turned_s = static_cast<double>(r.time_ns) * 1e-9;
    EXPECT_LE(std::abs(left - 0.55 * turned_s), tick_rad * 1.0001);
    EXPECT_LE(std::abs(right + 0.31 * turned_s), tick_rad * 1.0001);
  }
}

TEST(RoverSensors, NoiseHasItsSizeAndSensorsTheirOwn) {
  const std::vector<RoverState> states = drive_rover({.step_s = 0.05, .steps = 20'000});
  const RoverLsvConfig config{.noise_m_s = 7e-4};
  const auto first = read_lsv(states, config, 1, 0), second = read_lsv(states, config, 1, 1);
  double x = 0.0, y = 0.0, xy = 0.0, both = 0.0, wheel = 0.0;
  const auto encoders = read_encoders(states, {.noise_rad_s = 0.017}, 1);
  for (std::size_t k = 0; k < states.size(); ++k) {
    x += first[k].vx_m_s * first[k].vx_m_s;
    y += first[k].vy_m_s * first[k].vy_m_s;
    xy += first[k].vx_m_s * first[k].vy_m_s;
    both += first[k].vx_m_s * second[k].vx_m_s;
    wheel += encoders[k].left_rad_s * encoders[k].left_rad_s;
  }
  const int n = static_cast<int>(states.size());
  expect_variance(x, n, 4.9e-7);
  expect_variance(y, n, 4.9e-7);
  expect_variance(wheel, n, 0.017 * 0.017);
  EXPECT_LT(std::abs(xy / n), 4.0 * 4.9e-7 / std::sqrt(n));
  EXPECT_LT(std::abs(both / n), 4.0 * 4.9e-7 / std::sqrt(n));
}

TEST(RoverSensors, OutliersAreAsManyAsAskedFor) {
  const std::vector<RoverState> states = drive_rover({.step_s = 0.05, .steps = 20'000});
  int outliers = 0;
  for (const RoverLsvReading& r :
       read_lsv(states, {.outlier_share = 0.02, .outlier_m_s = 0.3}, 1, 0)) {
    outliers += r.vx_m_s != 0.0;
    EXPECT_LE(std::abs(r.vx_m_s), 0.3);
  }
  EXPECT_NEAR(outliers, 400, 80);
}

// The source's axes: vx = U - q w, vy = V + p w with the sensor p to the right and q forward.
TEST(RoverSensors, AnLsvFeelsItsLeverArm) {
  const RoverPlan plan{
      .step_s = 0.05, .steps = 1, .commands = {{1.0, 0.4, 0.6}}, .side_slips = {{0.0, 1.0, 0.002}}};
  const std::vector<RoverState> states = drive_rover(plan);
  const double p = 0.3, q = 0.35;
  const RoverLsvConfig config{.place = {.x_m = q, .y_m = -p, .yaw_rad = -std::numbers::pi / 2.0}};
  const RoverLsvReading reading = read_lsv(states, config, 1, 0)[0];
  EXPECT_NEAR(reading.vx_m_s, -0.002 - q * states[0].wz_rad_s, 1e-15);
  EXPECT_NEAR(reading.vy_m_s, states[0].vx_m_s + p * states[0].wz_rad_s, 1e-15);
}

TEST(RoverSensors, TheImuFeelsTurnsAndBias) {
  const std::vector<RoverState> states =
      drive_rover({.step_s = 0.05, .steps = 10, .commands = {{1e6, 0.4, 0.6}}});
  const ImuReading reading = read_imu(states, {.gyro_bias_rad_s = 0.01}, 1)[3];
  EXPECT_NEAR(reading.wz_rad_s, states[3].wz_rad_s + 0.01, 1e-15);
  EXPECT_NEAR(reading.ax_m_s2, 0.0, 1e-15);
  EXPECT_NEAR(reading.ay_m_s2, states[3].wz_rad_s * states[3].vx_m_s, 1e-15);
}

}  // namespace
}  // namespace lsv::sim
