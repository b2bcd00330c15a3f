// SPDX-License-Identifier: BSD-3-Clause
// What the sensors of a simulated rover say: encoders, LSV sensors, gyro and accelerometer. Noise
// by (seed, stream, sensor, row) as in philox.h. Pure functions; they allocate.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/drive_sensors.h"
#include "sim/rover_drive.h"

namespace lsv::sim {

struct EncoderConfig {
  double noise_rad_s = 0.0;
  /// Whole ticks are counted, and the rate is the mean one since the reading before. Unset: the
  /// rate at the stamp.
  std::optional<double> ticks_per_turn{};
};

struct EncoderReading {
  std::int64_t time_ns = 0;
  double left_rad_s = 0.0;
  double right_rad_s = 0.0;
};

/// With ticks there is none at the first stamp.
std::vector<EncoderReading> read_encoders(const std::vector<RoverState>& states,
                                          const EncoderConfig& config, std::uint64_t seed);

struct RoverLsvConfig {
  SensorPlace place{};
  double noise_m_s = 0.0;  // per axis
  /// Share of the readings with an error of its own per axis, uniform to either side.
  double outlier_share = 0.0;
  double outlier_m_s = 0.0;
  std::vector<Interval> lost{};  // nothing is read
};

struct RoverLsvReading {
  std::int64_t time_ns = 0;
  bool is_lost = false;
  double vx_m_s = 0.0;  // in the axes of the sensor; 0 when lost
  double vy_m_s = 0.0;
};

/// `sensor` tells the noises of several apart.
std::vector<RoverLsvReading> read_lsv(const std::vector<RoverState>& states,
                                      const RoverLsvConfig& config, std::uint64_t seed, int sensor);

struct ImuConfig {
  double gyro_noise_rad_s = 0.0;
  double gyro_bias_rad_s = 0.0;
  double accelerometer_noise_m_s2 = 0.0;
};

struct ImuReading {
  std::int64_t time_ns = 0;
  double wz_rad_s = 0.0;
  double ax_m_s2 = 0.0;  // body axes, without gravity
  double ay_m_s2 = 0.0;
};

std::vector<ImuReading> read_imu(const std::vector<RoverState>& states, const ImuConfig& config,
                                 std::uint64_t seed);

}  // namespace lsv::sim
