// SPDX-License-Identifier: BSD-3-Clause
// A rover with two driven wheels on ground of different grip, with its motion known exactly. Body
// frame (REP-103): x forward, y left, origin on the axle midway between the wheels; yaw
// counter-clockwise. A wheel that turns at w moves its side at radius w efficiency:
//   V = radius (wl el + wr er) / 2,   yaw rate = radius (wr er - wl el) / track
// (Masuku thesis 4.3, 4.4, with the signs of its Appendix D). Units as in the names.
// Pure functions of the plan; they allocate.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lsv::sim {

/// Efficiencies of the source: A hard ground 1, B 0.8, C 0.6, D 0.5, E 0.4; nothing for others.
std::optional<double> soil_efficiency(const std::string& soil);

/// Ground that is not hard: x and y strictly between the bounds.
struct SoilPatch {
  double left_m = 0.0, right_m = 0.0;  // bounds of x
  double bottom_m = 0.0, top_m = 0.0;  // bounds of y
  double efficiency_ratio = 1.0;
};

struct WheelCommand {
  double duration_s = 0.0;
  double left_rad_s = 0.0;
  double right_rad_s = 0.0;
};

struct SideSlip {
  double begin_s = 0.0;
  double end_s = 0.0;
  double vy_m_s = 0.0;  // to the left
};

/// Instead of commands: speeds that wander. Walks are standard deviations of the change in one
/// second; side slip and efficiencies are first-order Gauss-Markov about 0 and 1.
struct RandomDrive {
  double vx_m_s = 0.05;  // at the start
  double vx_walk_m_s = 0.01;
  double wz_walk_rad_s = 0.02;
  double vy_sigma_m_s = 0.003;
  double vy_time_s = 10.0;
  double efficiency_sigma_ratio = 0.1;
  double efficiency_time_s = 60.0;
};

/// `euler` moves along the heading at the beginning of a step, as the source does.
enum class RoverIntegrator { exact, euler };

struct RoverPlan {
  double radius_m = 0.1;
  double track_m = 0.8;
  double start_x_m = 0.0;
  double start_y_m = 0.0;
  double start_yaw_rad = 0.0;
  double step_s = 0.05;  // > 0; a whole number of ns
  int steps = 0;         // there is one state more
  RoverIntegrator integrator = RoverIntegrator::exact;
  std::vector<WheelCommand> commands{};  // at rest after the last
  std::vector<SoilPatch> patches{};      // by the contact point of each wheel; the first that fits
  double ramp_s = 0.0;  // in which the efficiency of a wheel falls from 1 to 0.5; 0: at once
  std::vector<SideSlip> side_slips{};
  std::optional<RandomDrive> random{};
  std::uint64_t seed = 1;
};

/// At a stamp; speeds and rates hold until the next (`random`: they are those at the stamp).
struct RoverState {
  std::int64_t time_ns = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;  // counts full turns
  double vx_m_s = 0.0;   // body axes
  double vy_m_s = 0.0;
  double wz_rad_s = 0.0;
  double left_rad_s = 0.0;  // of the wheels
  double right_rad_s = 0.0;
  double left_efficiency_ratio = 1.0;
  double right_efficiency_ratio = 1.0;
};

std::vector<RoverState> drive_rover(const RoverPlan& plan);

}  // namespace lsv::sim
