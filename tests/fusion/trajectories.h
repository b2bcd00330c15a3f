// SPDX-License-Identifier: BSD-3-Clause
// Trajectories for the tests of the evaluation.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "fusion/association.h"
#include "lsv/core/trajectory.h"

namespace lsv::test {

inline Quaternion turn_about_z(double angle_rad) {
  return {.x = 0.0, .y = 0.0, .z = std::sin(0.5 * angle_rad), .w = std::cos(0.5 * angle_rad)};
}

inline TrajectoryPose planar_pose(double time_s, double x_m, double y_m, double yaw_rad) {
  return {.stamp = {std::llround(time_s * 1e9)},
          .x_m = x_m,
          .y_m = y_m,
          .z_m = 0.0,
          .rotation = turn_about_z(yaw_rad)};
}

inline Trajectory planar(std::vector<TrajectoryPose> poses) {
  return {.poses = std::move(poses),
          .covariances = {},
          .has_time = true,
          .has_rotation = true,
          .is_planar = true};
}

/// Along x at 0.1 m a step, 10 steps a second.
inline Trajectory straight(int poses) {
  std::vector<TrajectoryPose> out;
  for (int i = 0; i < poses; ++i) out.push_back(planar_pose(0.1 * i, 0.1 * i, 0.0, 0.0));
  return planar(std::move(out));
}

/// Curves to both sides, at changing speed.
inline Trajectory winding(int poses) {
  std::vector<TrajectoryPose> out;
  double x_m = 2.0, y_m = -1.0, yaw_rad = 0.4;
  for (int i = 0; i < poses; ++i) {
    const double time_s = 0.1 * i;
    out.push_back(planar_pose(time_s, x_m, y_m, yaw_rad));
    const double step_m = 0.03 * (1.5 + std::sin(0.05 * i));
    x_m += step_m * std::cos(yaw_rad);
    y_m += step_m * std::sin(yaw_rad);
    yaw_rad += 0.05 * std::sin(0.11 * i) + 0.01;
  }
  return planar(std::move(out));
}

inline double normal(std::mt19937& random) {
  const auto uniform = [&random] { return (static_cast<double>(random()) + 0.5) / 4294967296.0; };
  const double radius = std::sqrt(-2.0 * std::log(uniform()));
  return radius * std::cos(2.0 * 3.14159265358979323846 * uniform());
}

inline PosePairs pairs_of(const Trajectory& estimate, const Trajectory& truth) {
  return associate(estimate, truth, {}).value();
}

}  // namespace lsv::test
