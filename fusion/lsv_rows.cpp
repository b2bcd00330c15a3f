// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/lsv_rows.h"

#include <algorithm>
#include <cmath>

namespace lsv::fusion {
namespace {

/// Of the largest column, squared: below it the readings say nothing of a direction of the motion.
constexpr double kNothing = 1e-9;

}  // namespace

LsvRows lsv_rows(const LsvConfig& mount) {
  Eigen::Matrix<double, 2, 3> body;
  body << 1.0, 0.0, -mount.y_m,  //
      0.0, 1.0, mount.x_m;
  const double c = std::cos(mount.yaw_rad), s = std::sin(mount.yaw_rad);
  Eigen::Matrix2d to_sensor;
  to_sensor << c, s, -s, c;
  return to_sensor * body;
}

void LsvStack::add(const LsvRows& h2, const Eigen::Vector2d& z2, const Eigen::Vector2d& variance2) {
  for (int axis = 0; axis < 2; ++axis)
    row[static_cast<std::size_t>(rows++)] = {h2.row(axis), z2(axis), variance2(axis)};
}

// Gram-Schmidt, largest column first, on the rows in units of their noise: what is left of the
// readings when all columns are taken out is the residual of the motion that fits them best.
Parity parity(const LsvStack& stack) {
  constexpr int kReadings = 3;
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::ColMajor, kMostRows, 4> a(stack.rows, 4);
  for (int k = 0; k < stack.rows; ++k) {
    const LsvRow& row = stack.row[static_cast<std::size_t>(k)];
    a.row(k) << row.h.transpose(), row.z;
    a.row(k) /= std::sqrt(row.variance);
  }
  int rank = 0;
  double least = 0.0;
  for (; rank < kReadings; ++rank) {
    int largest = rank;
    double squared_norm = 0.0;
    for (int i = rank; i < kReadings; ++i) {
      if (const double of_i = a.col(i).squaredNorm(); of_i > squared_norm) {
        squared_norm = of_i;
        largest = i;
      }
    }
    if (rank == 0) least = kNothing * squared_norm;
    if (!(squared_norm > least)) break;
    a.col(largest).swap(a.col(rank));
    for (int i = rank + 1; i <= kReadings; ++i)
      a.col(i) -= a.col(rank).dot(a.col(i)) / squared_norm * a.col(rank);
  }
  return {a.col(kReadings).squaredNorm(), stack.rows - rank};
}

// Row by row, each against what the rows before it leave open: nothing is to be inverted.
double innovation_chi2(const LsvStack& stack, Eigen::Vector3d motion, Eigen::Matrix3d covariance) {
  double chi2 = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(stack.rows); ++k) {
    const LsvRow& row = stack.row[k];
    const Eigen::Vector3d ph = covariance * row.h;
    const double s = std::max(row.h.dot(ph), 0.0) + row.variance;  // it may be rounded below zero
    const double innovation = row.z - row.h.dot(motion);
    const Eigen::Vector3d gain = 1.0 / s * ph;
    chi2 += innovation * innovation / s;
    motion += innovation * gain;
    covariance -= gain * ph.transpose();
  }
  return chi2;
}

}  // namespace lsv::fusion
