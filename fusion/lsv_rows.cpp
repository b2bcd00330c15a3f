// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/lsv_rows.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace lsv::fusion {
namespace {

/// Of the largest eigenvalue: below it the readings say nothing of a direction of the motion.
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

LsvStack::LsvStack() : h(0, 3), z(0), variance(0) {}

void LsvStack::add(const LsvRows& h2, const Eigen::Vector2d& z2, const Eigen::Vector2d& variance2) {
  h.conservativeResize(rows + 2, 3);
  z.conservativeResize(rows + 2);
  variance.conservativeResize(rows + 2);
  h.bottomRows<2>() = h2;
  z.tail<2>() = z2;
  variance.tail<2>() = variance2;
  rows += 2;
}

Parity parity(const LsvStack& stack) {
  const auto weight = stack.variance.cwiseInverse();
  const Eigen::Matrix3d information = stack.h.transpose() * weight.asDiagonal() * stack.h;
  const Eigen::Vector3d right = stack.h.transpose() * weight.cwiseProduct(stack.z);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
  const double least = kNothing * solver.eigenvalues()(2);
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  int rank = 0;
  for (int i = 0; i < 3; ++i) {
    if (!(solver.eigenvalues()(i) > least)) continue;
    const Eigen::Vector3d direction = solver.eigenvectors().col(i);
    motion += direction * (direction.dot(right) / solver.eigenvalues()(i));
    ++rank;
  }
  const auto residual = (stack.z - stack.h * motion).array().square() / stack.variance.array();
  return {residual.sum(), stack.rows - rank};
}

double innovation_chi2(const LsvStack& stack, const Eigen::Vector3d& motion,
                       const Eigen::Matrix3d& covariance) {
  using Square =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostRows, kMostRows>;
  Square s = stack.h * covariance * stack.h.transpose();
  s.diagonal() += stack.variance;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostRows, 1> innovation =
      stack.z - stack.h * motion;
  const Eigen::LLT<Square> factor(s);
  return innovation.dot(factor.solve(innovation));
}

}  // namespace lsv::fusion
