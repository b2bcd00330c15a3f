// SPDX-License-Identifier: BSD-3-Clause
// Where the rover is, how it moves and how its wheels grip, with uncertainty; and what became of
// the measurements. World axes: z up, yaw counter-clockwise from world x to body x. Plain values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "fusion/rover_config.h"
#include "lsv/core/shift.h"
#include "lsv/core/stamp.h"

namespace lsv {

enum class NavStatus {
  not_started,   // no sample yet
  ok,            //
  optical_lost,  // LSV sensors there are, but none was accepted lately: wheels and gyro carry on
  no_motion_source,  // nothing says how fast the rover is: its place is a guess that gets worse
};
std::string_view word(NavStatus status);

/// What tells turning from side slip, lately; the best there is.
enum class HeadingSource {
  nothing,    //
  side_slip,  // what the side slip is taken for: one LSV sensor, or several at one place
  wheels,     // turning and a change of the grip look alike
  gyro,       //
  optics,     // LSV sensors at different places
};
std::string_view word(HeadingSource source);

/// Symmetric, rows in the order of the names: x_m, y_m, yaw_rad, vx_m_s, vy_m_s, wz_rad_s.
using NavCovariance = std::array<std::array<double, 6>, 6>;

struct WheelGrip {
  double efficiency_ratio = kUnknown;  // ground speed / rim speed; NaN for a wheel at rest
  double sigma_ratio = kUnknown;
  bool is_slipping = false;    // the alarm: rim and ground differ, either way
  bool is_skidding = false;    // slower than the ground passes: braked, blocked, or not read at all
  bool is_slip_known = false;  // optics watched the last reading of the wheels
};

/// How well the last measurements of a kind agreed with what was predicted of them.
struct Agreement {
  double nis = kUnknown;  // normalised innovation squared, chi-square with `dof`; NaN: none
  int dof = 0;
};

struct NavState {
  Stamp stamp{};
  NavStatus status = NavStatus::not_started;
  HeadingSource heading = HeadingSource::nothing;
  double x_m = kUnknown;
  double y_m = kUnknown;
  double yaw_rad = kUnknown;  // counts full turns
  double vx_m_s = kUnknown;   // body axes
  double vy_m_s = kUnknown;   // side slip
  double wz_rad_s = kUnknown;
  /// Travelled since the start: the speed summed over time, without the corrections of the pose. At
  /// rest it grows with the noise of the speed.
  double path_m = kUnknown;
  NavCovariance cov{};
  WheelGrip left{};
  WheelGrip right{};
  double gyro_bias_rad_s = kUnknown;
  Agreement lsv{};  // of the samples at this stamp, refused or not
  Agreement wheels{};
  Agreement gyro{};
  std::array<bool, kMaxLsvSensors> lsv_refused{};  // at this stamp
  std::array<double, kMaxLsvSensors> lsv_nis{};    // of each sensor, chi-square with 2; NaN: none
};

/// What became of the samples of one LSV sensor.
struct LsvUse {
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;
  std::optional<Stamp> last_seen{};  // the last that was accepted
};

/// Of samples, from the start. Every refusal has its reason.
struct FusionCounters {
  std::array<LsvUse, kMaxLsvSensors> lsv{};  // in the order of FusionConfig::lsv
  std::uint64_t lsv_accepted = 0;
  std::uint64_t lsv_refused_by_parity = 0;      // the sensors contradict each other, this one odd
  std::uint64_t lsv_refused_by_innovation = 0;  // contradicts what was predicted
  std::uint64_t velocity_steps = 0;     // sensors agree on a jump: the motion was taken as unknown
  std::uint64_t lsv_streaks_ended = 0;  // too many refusals in a row: likewise
  std::uint64_t wheels_accepted = 0;
  std::uint64_t grip_opened = 0;  // wheels contradict the motion: their efficiency taken as unknown
  std::uint64_t wheel_steps = 0;  // likewise without optics: the motion taken as unknown
  std::uint64_t gyro_accepted = 0;
  std::uint64_t gyro_refused = 0;
  std::uint64_t standstills = 0;
  std::uint64_t updates_refused = 0;  // would have left a covariance that is none
  // not undone when time is gone back to:
  std::uint64_t late = 0;  // used all the same
  std::uint64_t too_late = 0;
  std::uint64_t invalid = 0;
};

}  // namespace lsv
