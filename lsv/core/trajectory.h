// SPDX-License-Identifier: BSD-3-Clause
// Poses over time, of a vehicle or of a camera, as files of trajectories hold them: T_world_body,
// which takes body coordinates to world coordinates. World axes with z up; a planar trajectory lies
// in z = 0. Plain values.
#pragma once

#include <cmath>
#include <vector>

#include "lsv/core/shift.h"
#include "lsv/core/stamp.h"

namespace lsv {

/// From body to world axes, of length 1. NaN where the orientation is unknown.
struct Quaternion {
  double x = kUnknown;
  double y = kUnknown;
  double z = kUnknown;
  double w = kUnknown;
};

/// Of body x about z, (-pi, pi]. NaN without rotation.
inline double heading_rad(const Quaternion& q) {
  return std::atan2(2.0 * (q.w * q.z + q.x * q.y), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z);
}

struct TrajectoryPose {
  Stamp stamp{};
  double x_m = kUnknown;
  double y_m = kUnknown;
  double z_m = kUnknown;
  Quaternion rotation{};
};

/// Of x, y and yaw in world axes. NaN where unknown.
struct PlanarCovariance {
  double xx_m2 = kUnknown;
  double xy_m2 = kUnknown;
  double yy_m2 = kUnknown;
  double xyaw_m_rad = kUnknown;
  double yyaw_m_rad = kUnknown;
  double yawyaw_rad2 = kUnknown;
};

struct Trajectory {
  std::vector<TrajectoryPose> poses;
  std::vector<PlanarCovariance> covariances;  // one for each pose, or none at all
  bool has_time = false;  // stamps increase strictly; else they are the indices of the poses
  bool has_rotation = false;
  bool is_planar = false;  // z, roll and pitch are not known and 0
};

}  // namespace lsv
