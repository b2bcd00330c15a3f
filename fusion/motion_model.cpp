// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/motion_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lsv::fusion {
namespace {

constexpr double kLongestStep_s = 0.1;
constexpr double kMostSteps = 200.0;

/// With the body turning by phi at a steady rate, its forward motion of length 1 takes it `along`
/// forward and `across` to the left, in the axes of the start.
struct Arc {
  double along, across;
  double d_along, d_across;  // by phi
};

Arc arc(double phi) {
  if (std::abs(phi) < 1e-4) {  // the next terms are below 1e-17
    return {1.0 - phi * phi / 6.0, phi / 2.0 - phi * phi * phi / 24.0, -phi / 3.0,
            0.5 - phi * phi / 8.0};
  }
  const double s = std::sin(phi), c = std::cos(phi);
  return {s / phi, (1.0 - c) / phi, (phi * c - s) / (phi * phi),
          (phi * s - (1.0 - c)) / (phi * phi)};
}

/// A walk of state `rate`, with its integral along `direction` of the plane, or in yaw.
void add_walk(double density, double dt_s, int rate, const Eigen::Vector3d& direction,
              StateMatrix& q) {
  const double into_place = density * dt_s * dt_s / 2.0;
  q.topLeftCorner<3, 3>() += density * dt_s * dt_s * dt_s / 3.0 * direction * direction.transpose();
  q.block<3, 1>(0, rate) += into_place * direction;
  q.block<1, 3>(rate, 0) += into_place * direction.transpose();
  q(rate, rate) += density * dt_s;
}

/// A walk of an acceleration, with its integral in the speed `rate` and in the place.
void add_acceleration_walk(double density, double dt_s, int acceleration, int rate,
                           const Eigen::Vector3d& direction, StateMatrix& q) {
  const double t2 = dt_s * dt_s, t3 = t2 * dt_s;
  q.topLeftCorner<3, 3>() += density * t3 * t2 / 20.0 * direction * direction.transpose();
  const Eigen::Vector3d place_rate = density * t2 * t2 / 8.0 * direction;
  const Eigen::Vector3d place_acceleration = density * t3 / 6.0 * direction;
  q.block<3, 1>(0, rate) += place_rate;
  q.block<1, 3>(rate, 0) += place_rate.transpose();
  q.block<3, 1>(0, acceleration) += place_acceleration;
  q.block<1, 3>(acceleration, 0) += place_acceleration.transpose();
  q(rate, rate) += density * t3 / 3.0;
  q(rate, acceleration) += density * t2 / 2.0;
  q(acceleration, rate) += density * t2 / 2.0;
  q(acceleration, acceleration) += density * dt_s;
}

double squared(double value) { return value * value; }

StateMatrix process_noise(const MotionConfig& motion, const SlipSigmas& slip, double dt_s,
                          double yaw_rad) {
  StateMatrix q = StateMatrix::Zero();
  const Eigen::Vector3d forward{std::cos(yaw_rad), std::sin(yaw_rad), 0.0};
  const Eigen::Vector3d left{-forward.y(), forward.x(), 0.0};
  const Eigen::Vector3d turn{0.0, 0.0, 1.0};
  add_walk(squared(motion.vx_walk_m_s), dt_s, kVx, forward, q);
  add_walk(squared(motion.wz_walk_rad_s), dt_s, kWz, turn, q);
  if (motion.vy_sigma_m_s > 0.0) {
    add_walk(2.0 * squared(motion.vy_sigma_m_s) / motion.vy_time_s, dt_s, kVy, left, q);
    q(kVy, kVy) = squared(motion.vy_sigma_m_s) * -std::expm1(-2.0 * dt_s / motion.vy_time_s);
  }
  const double renewed = -std::expm1(-2.0 * dt_s / motion.efficiency_time_s);
  q(kLeft, kLeft) = squared(slip.left_m_s) * renewed;
  q(kRight, kRight) = squared(slip.right_m_s) * renewed;
  if (motion.model == MotionModel::constant_acceleration) {
    add_acceleration_walk(squared(motion.ax_walk_m_s2), dt_s, kAx, kVx, forward, q);
    add_acceleration_walk(squared(motion.az_walk_rad_s2), dt_s, kAz, kWz, turn, q);
  }
  return q;
}

/// p f' in place of p. A state goes on by itself and by those behind it in the order of StateIndex,
/// and most of them not even by these.
void times_transposed(const StateMatrix& f, StateMatrix& p) {
  for (int i = 0; i < kStates; ++i) {
    if (f(i, i) != 1.0) p.col(i) *= f(i, i);
    for (int j = i + 1; j < kStates; ++j) {
      if (f(i, j) != 0.0) p.col(i) += f(i, j) * p.col(j);
    }
  }
}

}  // namespace

StateVector step(const MotionConfig& motion, double dt_s, const StateVector& x, StateMatrix& f) {
  const double keep_slip = std::exp(-dt_s / motion.vy_time_s);
  const double keep_grip = std::exp(-dt_s / motion.efficiency_time_s);
  // Mean speeds over the step; the side slip decays so slowly that its value will do.
  const double vx = x(kVx) + x(kAx) * dt_s / 2.0;
  const double vy = x(kVy);
  const double turn_rad = (x(kWz) + x(kAz) * dt_s / 2.0) * dt_s;
  const Arc a = arc(turn_rad);
  const Eigen::Rotation2Dd rotation(x(kYaw));
  const auto place = [&](double forward, double left) {
    return Eigen::Vector2d(rotation * Eigen::Vector2d(forward, left));
  };
  const Eigen::Vector2d by_vx = dt_s * place(a.along, a.across);
  const Eigen::Vector2d by_vy = dt_s * place(-a.across, a.along);
  const Eigen::Vector2d by_turn =
      dt_s * place(vx * a.d_along - vy * a.d_across, vx * a.d_across + vy * a.d_along);
  const Eigen::Vector2d travel = vx * by_vx + vy * by_vy;

  StateVector out = x;
  out.segment<2>(kX) += travel;
  out(kYaw) += turn_rad;
  out(kVx) += x(kAx) * dt_s;
  out(kVy) *= keep_slip;
  out(kWz) += x(kAz) * dt_s;
  out(kLeft) *= keep_grip;
  out(kRight) *= keep_grip;

  f.setIdentity();
  f.block<2, 1>(kX, kYaw) = Eigen::Vector2d(-travel.y(), travel.x());
  f.block<2, 1>(kX, kVx) = by_vx;
  f.block<2, 1>(kX, kVy) = by_vy;
  f.block<2, 1>(kX, kWz) = dt_s * by_turn;
  f(kYaw, kWz) = dt_s;
  f(kVy, kVy) = keep_slip;
  f(kLeft, kLeft) = f(kRight, kRight) = keep_grip;
  if (motion.model == MotionModel::constant_acceleration) {
    const double half = dt_s / 2.0;
    f.block<2, 1>(kX, kAx) = half * by_vx;
    f.block<2, 1>(kX, kAz) = half * dt_s * by_turn;
    f(kYaw, kAz) = half * dt_s;
    f(kVx, kAx) = f(kWz, kAz) = dt_s;
  }
  return out;
}

void predict(const MotionConfig& motion, const SlipSigmas& slip, double dt_s, StateVector& x,
             StateMatrix& p) {
  if (!(dt_s > 0.0)) return;
  const double steps = std::min(kMostSteps, std::ceil(dt_s / kLongestStep_s));
  const double step_s = dt_s / steps;
  StateMatrix f;
  for (int i = 0; i < static_cast<int>(steps); ++i) {
    const double middle_yaw_rad = x(kYaw) + x(kWz) * step_s / 2.0;
    const StateMatrix q = process_noise(motion, slip, step_s, middle_yaw_rad);
    x = step(motion, step_s, x, f);
    times_transposed(f, p);
    p.transposeInPlace();
    times_transposed(f, p);
    p += q;
    p.triangularView<Eigen::StrictlyUpper>() = p.transpose();  // not what was rounded
  }
}

}  // namespace lsv::fusion
