// SPDX-License-Identifier: BSD-3-Clause
// How the state of the rover goes on between two samples: exact arcs, random walks of the speeds,
// Gauss-Markov side slip and wheel slip. Equations: docs/fusion.md.
// Internal to fusion/. Pure functions, no allocation.
#pragma once

#include <Eigen/Core>

#include "fusion/rover_config.h"

namespace lsv::fusion {

/// Places of the state vector.
enum StateIndex : int {
  kX,     // m
  kY,     // m
  kYaw,   // rad, counts full turns
  kVx,    // m/s, body axes
  kVy,    // m/s
  kWz,    // rad/s
  kLeft,  // slip speed of the left wheel: rim speed - ground speed, m/s
  kRight,
  kBias,  // of the gyro, rad/s
  kAx,    // m/s^2, zero with MotionModel::constant_velocity
  kAz,    // rad/s^2, likewise
  kStates
};
using StateVector = Eigen::Matrix<double, kStates, 1>;
using StateMatrix = Eigen::Matrix<double, kStates, kStates>;

/// Stationary standard deviation of the slip speeds: that of the efficiency times the rim speed.
struct SlipSigmas {
  double left_m_s = 0.0;
  double right_m_s = 0.0;
};

/// `dt_s` >= 0. Long times go in steps, within which heading and speeds count as steady for the
/// process noise.
void predict(const MotionConfig& motion, const SlipSigmas& slip, double dt_s, StateVector& x,
             StateMatrix& p);

/// One step: the state after `dt_s`, and its derivative by the state before.
StateVector step(const MotionConfig& motion, double dt_s, const StateVector& x, StateMatrix& f);

}  // namespace lsv::fusion
