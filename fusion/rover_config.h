// SPDX-License-Identifier: BSD-3-Clause
// A rover as the navigator sees it: geometry, mounts, noises, how it can move. Body axes REP-103,
// origin on the axle, midway between the wheels. Defaults stand here and nowhere else.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lsv/core/result.h"
#include "lsv/core/shift.h"

namespace lsv {

inline constexpr std::size_t kMaxLsvSensors = 8;

struct WheelConfig {
  double radius_m = kUnknown;     // > 0; slip is relative to it
  double track_m = kUnknown;      // between the wheels, > 0
  double noise_rad_s = kUnknown;  // of one reading, > 0
  /// Of the encoder, per turn of the wheel, > 0. Unset: rates are not quantised.
  std::optional<double> ticks_per_turn{};
};

struct LsvConfig {
  std::string name{};
  double x_m = kUnknown;        // forward
  double y_m = kUnknown;        // left
  double yaw_rad = 0.0;         // from body x to sensor x
  double noise_m_s = kUnknown;  // > 0; of a sample that does not say
  /// Of the scale, [0, 0.1]: each figure of a sample has this share of itself as a further sigma.
  /// The default is what 0.4 mm make between the distances of laser and sensor, at 100 mm
  /// (docs/geometry.md).
  double sigma_scale_ratio = 0.002;
};

struct GyroConfig {
  double noise_rad_s = kUnknown;  // of one reading, > 0
  /// Of the constant that it reads too much, >= 0; 0: there is none. The default is 1.1 deg/s, as
  /// data sheets of small gyros have it; a standstill or two LSV sensors find it within seconds.
  double bias_sigma_rad_s = 0.02;
};

/// At the beginning of the first interval that was measured.
struct StartConfig {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double sigma_m = 0.0;  // per axis, >= 0
  double sigma_yaw_rad = 0.0;
};

enum class MotionModel { constant_velocity, constant_acceleration };

/// Process noise. A walk is the standard deviation of the change in one second.
struct MotionConfig {
  MotionModel model = MotionModel::constant_velocity;
  double vx_walk_m_s = 0.01;    // > 0
  double wz_walk_rad_s = 0.02;  // > 0
  /// Of the accelerations, `constant_acceleration` only.
  double ax_walk_m_s2 = 0.01;
  double az_walk_rad_s2 = 0.02;
  /// Side slip and efficiency return to 0 and 1 with these times (first-order Gauss-Markov).
  double vy_sigma_m_s = 0.003;  // >= 0
  double vy_time_s = 10.0;      // > 0
  double efficiency_sigma_ratio = 0.25;
  double efficiency_time_s = 60.0;
};

struct SlipConfig {
  double alarm_ratio = 0.15;      // slip 1 - v / (r w) that is to be told
  double threshold_sigmas = 4.0;  // of the cumulative sum
};

struct FusionConfig {
  std::optional<WheelConfig> wheels{};
  std::vector<LsvConfig> lsv{};  // at most kMaxLsvSensors
  std::optional<GyroConfig> gyro{};
  StartConfig start{};
  MotionConfig motion{};
  SlipConfig slip{};
  double gate_probability = 1e-5;  // that a good measurement is refused, (0, 0.1]
  int max_rejected_in_a_row = 4;   // >= 1; then the velocity is taken as unknown
  double optical_timeout_s = 0.1;  // without an accepted LSV sample: `optical_lost`
  double same_time_s = 1e-4;       // samples closer than this are of one time
  std::size_t late_epochs = 256;   // sample times that can be gone back to, >= 1
};

/// The first value that is out of its range, named with its value.
Result<void> validate(const FusionConfig& config);

/// What is known of the motion (forward speed, side slip, yaw rate) by the LSV sensors alone.
struct MountingRank {
  int rank = 0;           // 0 to 3
  double spread_m = 0.0;  // largest distance between two sensors: yaw rate = velocity / spread
};
MountingRank mounting_rank(const std::vector<LsvConfig>& lsv);

/// One line each: what a user must know before trusting the pose.
std::vector<std::string> mounting_warnings(const FusionConfig& config);

}  // namespace lsv
