// SPDX-License-Identifier: BSD-3-Clause
// Plain poses as Eigen sees them. For sources of fusion/, not for public headers.
#pragma once

#include <Eigen/Geometry>

#include "lsv/core/trajectory.h"

namespace lsv {

inline Eigen::Quaterniond eigen_of(const Quaternion& q) { return {q.w, q.x, q.y, q.z}; }

inline Quaternion plain_of(const Eigen::Quaterniond& q) {
  return {.x = q.x(), .y = q.y(), .z = q.z(), .w = q.w()};
}

inline Eigen::Vector3d position_of(const TrajectoryPose& pose) {
  return {pose.x_m, pose.y_m, pose.z_m};
}

}  // namespace lsv
