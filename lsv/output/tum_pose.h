// SPDX-License-Identifier: BSD-3-Clause
// One line of a trajectory in the TUM RGB-D format, "t x y z qx qy qz qw".
#pragma once

#include <string>

#include "lsv/core/stamp.h"

namespace lsv {

/// A pose in the plane z = 0, yaw counter-clockwise about z. Appends to `out`, which keeps its
/// memory; position and yaw must be finite. Without yaw the rotation is "0 0 0 1".
void append_tum_pose(std::string& out, Stamp stamp, double x_m, double y_m, double yaw_rad = 0.0);

}  // namespace lsv
