// SPDX-License-Identifier: BSD-3-Clause
// Simulated drives through the navigator, for the tests of the fusion: what the rover and its
// sensors are, what the navigator believes, and one drive from sample to sample.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "fusion/navigator.h"
#include "sim/rover_drive.h"
#include "sim/rover_sensors.h"

namespace lsv::test {

inline constexpr double kStart_rad = 40.0 * 3.14159265358979323846 / 180.0;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The sand crossing: 120 s, about 5.4 m, a band of sand at 2 < y < 3 with ramps of 1 s.
inline sim::RoverPlan sand_plan() {
  return {.start_yaw_rad = kStart_rad,
          .step_s = 0.05,
          .steps = 2400,
          .commands = {{1e6, 0.55, 0.55}},
          .patches = {{-kInfinity, kInfinity, 2.0, 3.0, 0.5}},
          .ramp_s = 1.0};
}

/// The source's places (p right, q forward): (-0.25, 0.20) and (0.30, 0.35).
inline std::vector<sim::RoverLsvConfig> two_sensors() {
  return {{.place = {.x_m = 0.20, .y_m = 0.25}, .noise_m_s = 7e-4},
          {.place = {.x_m = 0.35, .y_m = -0.30}, .noise_m_s = 7e-4}};
}

struct RoverTrial {
  sim::RoverPlan plan = sand_plan();
  std::vector<sim::RoverLsvConfig> lsv = two_sensors();
  bool has_wheels = true;
  std::optional<sim::ImuConfig> imu{};
  /// Changes to what the navigator believes.
  std::function<void(FusionConfig&)> adjust = [](FusionConfig&) {};
  double lsv_sigma_factor = 1.0;  // that it is told
  /// What becomes of a reading on its way.
  std::function<void(double time_s, WheelSample&)> wheels_become = [](double, WheelSample&) {};
  std::function<void(std::size_t sensor, LsvSample&)> lsv_becomes = [](std::size_t, LsvSample&) {};
};

inline FusionConfig config_of(const RoverTrial& trial) {
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

using EachState = std::function<void(const sim::RoverState&, const NavState&)>;

/// Every sample in its turn; `each` sees truth and estimate at every stamp.
inline FusionCounters drive(RoverTrial trial, std::uint64_t seed, const EachState& each) {
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
      LsvSample sample{.stamp = stamp, .vx_m_s = r.vx_m_s, .vy_m_s = r.vy_m_s};
      trial.lsv_becomes(i, sample);
      if (!r.is_lost) nav.add(i, sample);
    }
    if (trial.imu) nav.add(GyroSample{stamp, imu[k].wz_rad_s});
    WheelSample sample{stamp, wheels[k].left_rad_s, wheels[k].right_rad_s};
    trial.wheels_become(static_cast<double>(stamp.ns) * 1e-9, sample);
    if (trial.has_wheels) nav.add(sample);
    each(truth[k], nav.state_at(stamp));
  }
  return nav.counters();
}

inline double squared_error_m2(const sim::RoverState& truth, const NavState& state) {
  return std::pow(state.x_m - truth.x_m, 2) + std::pow(state.y_m - truth.y_m, 2);
}

}  // namespace lsv::test
