// SPDX-License-Identifier: BSD-3-Clause
// What an LSV sensor on the body sees of the motion of the body: two rows on (vx, vy, wz). A sensor
// at (x, y) moves with (vx - wz y, vy + wz x) in body axes, which it reads turned by -yaw into its
// own. Internal to fusion/. Pure functions, no allocation.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "fusion/rover_config.h"

namespace lsv::fusion {

using LsvRows = Eigen::Matrix<double, 2, 3>;

LsvRows lsv_rows(const LsvConfig& mount);

/// One figure of a sensor: z = h motion, give or take.
struct LsvRow {
  Eigen::Vector3d h;
  double z;
  double variance;
};

/// The readings of one time, stacked; fixed room, so that nothing is allocated.
inline constexpr int kMostRows = 2 * static_cast<int>(kMaxLsvSensors);
struct LsvStack {
  int rows = 0;
  std::array<LsvRow, kMostRows> row;

  void add(const LsvRows& h2, const Eigen::Vector2d& z2, const Eigen::Vector2d& variance2);
};

/// What the readings say against each other, whatever the motion: the residual of the motion that
/// fits them best, chi-square with `dof`.
struct Parity {
  double chi2 = 0.0;
  int dof = 0;
};
Parity parity(const LsvStack& stack);

/// What they say against a prediction of the motion with covariance.
double innovation_chi2(const LsvStack& stack, Eigen::Vector3d motion, Eigen::Matrix3d covariance);

}  // namespace lsv::fusion
