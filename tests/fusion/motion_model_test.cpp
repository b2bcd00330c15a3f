// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/motion_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lsv::fusion {
namespace {

StateVector state_of(double yaw_rad, double vx_m_s, double vy_m_s, double wz_rad_s) {
  StateVector x = StateVector::Zero();
  x(kX) = 0.3;
  x(kY) = -0.2;
  x(kYaw) = yaw_rad;
  x(kVx) = vx_m_s;
  x(kVy) = vy_m_s;
  x(kWz) = wz_rad_s;
  x(kLeft) = 0.7;
  x(kRight) = 0.9;
  x(kBias) = 0.01;
  return x;
}

MotionConfig accelerating() {
  return {.model = MotionModel::constant_acceleration, .vy_time_s = 1e9};
}

TEST(MotionModel, AFullCircleEndsWhereItBegan) {
  const double radius_m = 0.5, wz_rad_s = 0.4;
  StateVector x = state_of(0.3, radius_m * wz_rad_s, 0.0, wz_rad_s);
  const StateVector start = x;
  StateMatrix f;
  const double turn_s = 2.0 * std::numbers::pi / wz_rad_s;
  const StateVector half = step({}, turn_s / 2.0, x, f);
  // Left of the heading by a diameter.
  EXPECT_NEAR(half(kX), start(kX) - 2.0 * radius_m * std::sin(0.3), 1e-12);
  EXPECT_NEAR(half(kY), start(kY) + 2.0 * radius_m * std::cos(0.3), 1e-12);
  x = step({}, turn_s, x, f);
  EXPECT_NEAR(x(kX), start(kX), 1e-12);
  EXPECT_NEAR(x(kY), start(kY), 1e-12);
  EXPECT_NEAR(x(kYaw), start(kYaw) + 2.0 * std::numbers::pi, 1e-12);
}

TEST(MotionModel, SideSlipIsToTheLeftOfTheHeading) {
  StateMatrix f;
  const StateVector x =
      step({.vy_time_s = 1e9}, 2.0, state_of(std::numbers::pi / 2, 0.0, 0.1, 0.0), f);
  EXPECT_NEAR(x(kX), 0.3 - 0.2, 1e-9);
  EXPECT_NEAR(x(kY), -0.2, 1e-9);
}

TEST(MotionModel, AcceleratesInAStraightLine) {
  StateVector x = state_of(0.0, 0.1, 0.0, 0.0);
  x(kAx) = 0.05;
  StateMatrix f;
  const StateVector out = step(accelerating(), 2.0, x, f);
  EXPECT_NEAR(out(kX), 0.3 + 0.1 * 2.0 + 0.5 * 0.05 * 4.0, 1e-12);
  EXPECT_NEAR(out(kVx), 0.2, 1e-12);
}

TEST(MotionModel, SlipAndGripReturn) {
  StateMatrix f;
  const MotionConfig motion{.vy_time_s = 2.0, .efficiency_time_s = 4.0};
  const StateVector x = step(motion, 2.0, state_of(0.0, 0.0, 0.1, 0.0), f);
  EXPECT_NEAR(x(kVy), 0.1 * std::exp(-1.0), 1e-12);
  EXPECT_NEAR(x(kLeft), 0.7 * std::exp(-0.5), 1e-12);
}

// At rest, at 1e-8, in between and fast: the derivative is that of finite differences.
TEST(MotionModel, DerivativeAgreesWithDifferences) {
  constexpr double kDt_s = 0.05;
  for (const double wz_rad_s : {0.0, 1e-8, 1.9e-3, 2.1e-3, -0.7, 9.0}) {
    for (const MotionModel model :
         {MotionModel::constant_velocity, MotionModel::constant_acceleration}) {
      MotionConfig motion = accelerating();
      motion.model = model;
      StateVector x = state_of(0.9, 0.3, -0.05, wz_rad_s);
      if (model == MotionModel::constant_acceleration) {
        x(kAx) = 0.2;
        x(kAz) = -0.3;
      }
      StateMatrix f, unused;
      (void)step(motion, kDt_s, x, f);
      const int states = model == MotionModel::constant_acceleration ? kStates : kAx;
      for (int j = 0; j < states; ++j) {
        constexpr double kSmall = 1e-6;
        StateVector up = x, down = x;
        up(j) += kSmall;
        down(j) -= kSmall;
        const StateVector slope =
            (step(motion, kDt_s, up, unused) - step(motion, kDt_s, down, unused)) / (2.0 * kSmall);
        EXPECT_LT((slope - f.col(j)).cwiseAbs().maxCoeff(), 1e-8)
            << "column " << j << ", wz " << wz_rad_s;
      }
    }
  }
}

// F P F', whatever entries of F are taken for empty.
TEST(MotionModel, CovarianceGoesWithTheDerivative) {
  MotionConfig motion = accelerating();
  motion.vx_walk_m_s = motion.wz_walk_rad_s = motion.vy_sigma_m_s = 0.0;
  motion.ax_walk_m_s2 = motion.az_walk_rad_s2 = 0.0;
  motion.vy_time_s = 2.0;
  StateVector x = state_of(0.9, 0.3, -0.05, 0.7);
  x(kAx) = 0.2;
  x(kAz) = -0.3;
  StateMatrix root, f;
  for (int i = 0; i < kStates; ++i) {
    for (int j = 0; j < kStates; ++j) root(i, j) = std::sin(1.0 + i + 3.7 * j);
  }
  StateMatrix p = root * root.transpose();
  (void)step(motion, 0.1, x, f);
  const StateMatrix expected = f * p * f.transpose();
  predict(motion, {}, 0.1, x, p);
  EXPECT_LT((p - expected).cwiseAbs().maxCoeff(), 1e-13 * expected.cwiseAbs().maxCoeff());
  EXPECT_EQ(p, p.transpose());
}

// Straight ahead everything is linear, so that one long step and many short ones say the same.
TEST(MotionModel, CovarianceDoesNotDependOnTheStep) {
  MotionConfig motion = accelerating();
  motion.vy_sigma_m_s = 0.0;
  StateVector x = state_of(0.4, 0.0, 0.0, 0.0), y = x;
  StateMatrix p = 1e-4 * StateMatrix::Identity(), q = p;
  predict(motion, {}, 0.1, x, p);
  for (int i = 0; i < 10; ++i) predict(motion, {}, 0.01, y, q);
  EXPECT_LT((p - q).cwiseAbs().maxCoeff(), 1e-12 * p.cwiseAbs().maxCoeff() + 1e-15);
  EXPECT_GT(p(kX, kX), 1e-4);
}

TEST(MotionModel, UncertaintyGrowsWithoutMeasurements) {
  StateVector x = state_of(0.4, 0.05, 0.001, 0.02);
  StateMatrix p = StateMatrix::Zero();
  double last = 0.0;
  for (int i = 0; i < 100; ++i) {
    predict({}, {}, 0.1, x, p);
    EXPECT_GT(p(kX, kX), last);
    last = p(kX, kX);
    EXPECT_LT((p - p.transpose()).cwiseAbs().maxCoeff(), 1e-15);
  }
}

}  // namespace
}  // namespace lsv::fusion
