// SPDX-License-Identifier: BSD-3-Clause
// A first look at two paths of one rigid body, by linear least squares: `path` is what one sensor
// summed up, turned by the heading, `target` the path of another sensor or of the body itself. With
// the heading h, along every unbroken chain of rows,
//   target = start + [a -b; b a] path + R(h) c
// Headings count as exact. That costs little: the paths are compared as wholes, not step by step.
// Internal to calibration/.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace lsv {

struct RigidRow {
  bool begins_chain = false;
  double yaw_rad = 0.0;
  Eigen::Vector2d path_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d target_m = Eigen::Vector2d::Zero();
};

struct RigidStart {
  double a = 0.0;
  double b = 0.0;
  Eigen::Vector2d c_m = Eigen::Vector2d::Zero();
  /// Target less fit, per row, about the median of the chain: where a chain starts is not fitted.
  std::vector<Eigen::Vector2d> residuals_m;
};

/// With `c_m` given, only the matrix is found.
RigidStart rigid_start(const std::vector<RigidRow>& rows,
                       const std::optional<Eigen::Vector2d>& c_m);

}  // namespace lsv
