// SPDX-License-Identifier: BSD-3-Clause
#include "sim/rover_sensors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/philox.h"

namespace lsv::sim {
namespace {

struct NormalPair {
  double first, second;
};

NormalPair normal_pair(std::uint64_t seed, Stream stream, std::int64_t row, std::int64_t sensor,
                       std::int64_t what) {
  const std::complex<double> z = std::sqrt(2.0) * complex_normal(seed, stream, row, sensor, what);
  return {z.real(), z.imag()};
}

double seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

}  // namespace

std::vector<EncoderReading> read_encoders(const std::vector<RoverState>& states,
                                          const EncoderConfig& config, std::uint64_t seed) {
  std::vector<EncoderReading> out;
  double left_rad = 0.0, right_rad = 0.0;
  const double tick_rad =
      config.ticks_per_turn ? 2.0 * std::numbers::pi / *config.ticks_per_turn : 0.0;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const RoverState& now = states[k];
    const auto [left_noise, right_noise] =
        normal_pair(seed, Stream::encoder, static_cast<std::int64_t>(k), 0, 0);
    EncoderReading reading{now.time_ns, now.left_rad_s, now.right_rad_s};
    if (config.ticks_per_turn) {
      if (k == 0) continue;
      const RoverState& before = states[k - 1];
      const double dt_s = seconds(now.time_ns - before.time_ns);
      const double left_from = std::floor(left_rad / tick_rad);
      const double right_from = std::floor(right_rad / tick_rad);
      left_rad += before.left_rad_s * dt_s;
      right_rad += before.right_rad_s * dt_s;
      reading.left_rad_s = (std::floor(left_rad / tick_rad) - left_from) * tick_rad / dt_s;
      reading.right_rad_s = (std::floor(right_rad / tick_rad) - right_from) * tick_rad / dt_s;
    }
    reading.left_rad_s += config.noise_rad_s * left_noise;
    reading.right_rad_s += config.noise_rad_s * right_noise;
    out.push_back(reading);
  }
  return out;
}

std::vector<RoverLsvReading> read_lsv(const std::vector<RoverState>& states,
                                      const RoverLsvConfig& config, std::uint64_t seed,
                                      int sensor) {
  std::vector<RoverLsvReading> out;
  out.reserve(states.size());
  const double c = std::cos(config.place.yaw_rad), s = std::sin(config.place.yaw_rad);
  for (std::size_t k = 0; k < states.size(); ++k) {
    const RoverState& now = states[k];
    const auto row = static_cast<std::int64_t>(k);
    const double time_s = seconds(now.time_ns);
    RoverLsvReading reading{.time_ns = now.time_ns};
    reading.is_lost = std::any_of(config.lost.begin(), config.lost.end(), [&](const Interval& gap) {
      return time_s >= gap.begin_s && time_s < gap.end_s;
    });
    if (!reading.is_lost) {
      const double forward_m_s = now.vx_m_s - now.wz_rad_s * config.place.y_m;
      const double left_m_s = now.vy_m_s + now.wz_rad_s * config.place.x_m;
      const auto [noise_x, noise_y] = normal_pair(seed, Stream::lsv_noise, row, sensor, 0);
      reading.vx_m_s =
          config.place.reads_ratio * (c * forward_m_s + s * left_m_s) + config.noise_m_s * noise_x;
      reading.vy_m_s =
          config.place.reads_ratio * (c * left_m_s - s * forward_m_s) + config.noise_m_s * noise_y;
      const auto [chance, unused] = uniform_pair(seed, Stream::lsv_outlier, row, sensor, 0);
      if (chance <= config.outlier_share) {
        const auto [x, y] = uniform_pair(seed, Stream::lsv_outlier, row, sensor, 1);
        reading.vx_m_s += config.outlier_m_s * (2.0 * x - 1.0);
        reading.vy_m_s += config.outlier_m_s * (2.0 * y - 1.0);
      }
    }
    out.push_back(reading);
  }
  return out;
}

std::vector<ImuReading> read_imu(const std::vector<RoverState>& states, const ImuConfig& config,
                                 std::uint64_t seed) {
  std::vector<ImuReading> out;
  out.reserve(states.size());
  for (std::size_t k = 0; k < states.size(); ++k) {
    const RoverState& now = states[k];
    const RoverState& next = states[std::min(k + 1, states.size() - 1)];
    const double dt_s = seconds(next.time_ns - now.time_ns);
    const double dvx_m_s2 = dt_s > 0.0 ? (next.vx_m_s - now.vx_m_s) / dt_s : 0.0;
    const double dvy_m_s2 = dt_s > 0.0 ? (next.vy_m_s - now.vy_m_s) / dt_s : 0.0;
    const auto row = static_cast<std::int64_t>(k);
    const auto [turn, unused] = normal_pair(seed, Stream::imu, row, 0, 0);
    const auto [x, y] = normal_pair(seed, Stream::imu, row, 0, 1);
    out.push_back(
        {.time_ns = now.time_ns,
         .wz_rad_s = now.wz_rad_s + config.gyro_bias_rad_s + config.gyro_noise_rad_s * turn,
         .ax_m_s2 = dvx_m_s2 - now.wz_rad_s * now.vy_m_s + config.accelerometer_noise_m_s2 * x,
         .ay_m_s2 = dvy_m_s2 + now.wz_rad_s * now.vx_m_s + config.accelerometer_noise_m_s2 * y});
  }
  return out;
}

}  // namespace lsv::sim
