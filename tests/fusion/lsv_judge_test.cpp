// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/lsv_judge.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "fusion/chi_square.h"

namespace lsv::fusion {
namespace {

constexpr double kSigma_m_s = 7e-4;

class LsvJudge : public testing::Test {
 protected:
  LsvJudge() {
    for (std::size_t dof = 1; dof < limits_.size(); ++dof)
      limits_[dof] = chi_square_limit(1e-5, static_cast<int>(dof));
    mount({.x_m = 0.20, .y_m = 0.25});
    mount({.x_m = 0.35, .y_m = -0.30, .yaw_rad = 0.4});
  }
  void mount(const LsvConfig& config) { mounts_[sensors_++] = lsv_rows(config); }

  /// All sensors see `motion` without noise.
  void see(const Eigen::Vector3d& motion) {
    for (std::size_t i = 0; i < sensors_; ++i)
      readings_[i] = {true, mounts_[i] * motion,
                      Eigen::Vector2d::Constant(kSigma_m_s * kSigma_m_s)};
  }
  LsvJudgement judged(bool was_odd = false) const {
    return judge(readings_, mounts_, limits_, predicted_,
                 Eigen::Vector3d(1e-5, 1e-6, 1e-5).asDiagonal(), was_odd);
  }

  std::size_t sensors_ = 0;
  LsvReadings readings_{};
  LsvMounts mounts_{};
  GateLimits limits_{};
  Eigen::Vector3d predicted_{0.055, 0.0, 0.02};
};

// The source: vx = U - q w, vy = V + p w with axes right and forward and the sensor at (p, q).
TEST_F(LsvJudge, RowsAreThoseOfTheSource) {
  const double p = 0.3, q = 0.35, u = 0.01, v = 0.05, w = 0.2;
  const LsvRows rows = lsv_rows({.x_m = q, .y_m = -p, .yaw_rad = -std::numbers::pi / 2});
  const Eigen::Vector2d seen = rows * Eigen::Vector3d(v, -u, w);
  EXPECT_NEAR(seen(0), u - q * w, 1e-15);
  EXPECT_NEAR(seen(1), v + p * w, 1e-15);
}

TEST_F(LsvJudge, BelievesWhatFits) {
  see(predicted_);
  EXPECT_EQ(judged().verdict[0], LsvVerdict::believed);
  EXPECT_EQ(judged().verdict[1], LsvVerdict::believed);
  EXPECT_EQ(judged().verdict[2], LsvVerdict::absent);
  EXPECT_FALSE(judged().is_jump);
}

TEST_F(LsvJudge, RefusesTheOddOneWhicheverItIs) {
  for (std::size_t odd = 0; odd < 2; ++odd) {
    for (int way = 0; way < 16; ++way) {
      see(predicted_);
      const double angle = way * std::numbers::pi / 8.0;
      readings_[odd].v_m_s += 0.1 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const LsvJudgement out = judged();
      EXPECT_NE(out.verdict[odd], LsvVerdict::believed) << odd << " " << way;
      EXPECT_EQ(out.verdict[1 - odd], LsvVerdict::believed) << odd << " " << way;
      EXPECT_FALSE(out.is_jump);
    }
  }
}

TEST_F(LsvJudge, NeverRefusesAJumpThatBothSee) {
  for (const Eigen::Vector3d& jump :
       {Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d(-0.0275, 0.0, 0.0),
        Eigen::Vector3d(0.0, 0.05, 0.0), Eigen::Vector3d(0.0, 0.0, 1.0)}) {
    see(predicted_ + jump);
    EXPECT_TRUE(judged().is_jump);
    EXPECT_EQ(judged().verdict[0], LsvVerdict::believed);
    EXPECT_EQ(judged().verdict[1], LsvVerdict::believed);
  }
}

// Turning about one of the sensors looks like an outlier of the other, but not twice.
TEST_F(LsvJudge, AJumpAboutOneSensorIsBelievedTheSecondTime) {
  const double wz_rad_s = 0.5;
  see(predicted_ + Eigen::Vector3d(wz_rad_s * 0.25, -wz_rad_s * 0.20, wz_rad_s));
  const LsvJudgement first = judged(false);
  EXPECT_EQ(first.verdict[1], LsvVerdict::refused_by_innovation);
  EXPECT_TRUE(first.is_odd_in_agreement);
  EXPECT_TRUE(judged(true).is_jump);
}

TEST_F(LsvJudge, BothWrongAndApartAreBothRefused) {
  see(predicted_);
  readings_[0].v_m_s += Eigen::Vector2d(0.2, -0.1);
  readings_[1].v_m_s += Eigen::Vector2d(-0.1, 0.15);
  EXPECT_FALSE(judged().is_any_believed);
  EXPECT_EQ(judged().verdict[0], LsvVerdict::refused_by_parity);
}

TEST_F(LsvJudge, OfThreeTheOddOneIsFoundEvenInAJump) {
  mount({.x_m = -0.3, .y_m = 0.1});
  see(predicted_ + Eigen::Vector3d(0.1, 0.02, -0.3));
  readings_[1].v_m_s += Eigen::Vector2d(0.0, 0.1);
  const LsvJudgement out = judged();
  EXPECT_TRUE(out.is_jump);
  EXPECT_EQ(out.verdict[0], LsvVerdict::believed);
  EXPECT_EQ(out.verdict[1], LsvVerdict::refused_by_parity);
  EXPECT_EQ(out.verdict[2], LsvVerdict::believed);
}

TEST_F(LsvJudge, OneAloneHasNothingButThePrediction) {
  see(predicted_ + Eigen::Vector3d(0.1, 0.0, 0.0));
  readings_[1].is_there = false;
  EXPECT_EQ(judged().verdict[0], LsvVerdict::refused_by_innovation);
  EXPECT_FALSE(judged().is_jump);
}

// By the definitions: weighted least squares, and the inverse of the covariance of the innovation.
TEST_F(LsvJudge, ChiSquaresAreThoseOfTheDefinition) {
  mount({.x_m = -0.3, .y_m = 0.1, .yaw_rad = -2.0});
  see(predicted_ + Eigen::Vector3d(0.003, -0.002, 0.004));
  readings_[1].v_m_s += Eigen::Vector2d(2e-3, -1e-3);
  readings_[2].variance_m2_s2 *= 9.0;
  Eigen::Matrix<double, 6, 3> h;
  Eigen::Matrix<double, 6, 1> z, variance;
  for (int i = 0; i < 3; ++i) {
    const auto sensor = static_cast<std::size_t>(i);
    h.middleRows<2>(2 * i) = mounts_[sensor];
    z.segment<2>(2 * i) = readings_[sensor].v_m_s;
    variance.segment<2>(2 * i) = readings_[sensor].variance_m2_s2;
  }
  const LsvStack stack = stack_of(readings_, mounts_, {true, true, true});

  const Eigen::Matrix<double, 6, 6> weight = variance.cwiseInverse().asDiagonal();
  const Eigen::Vector3d best = (h.transpose() * weight * h).inverse() * h.transpose() * weight * z;
  const Eigen::Matrix<double, 6, 1> residual = z - h * best;
  EXPECT_EQ(parity(stack).dof, 3);
  EXPECT_NEAR(parity(stack).chi2, residual.dot(weight * residual), 1e-9);

  Eigen::Matrix3d covariance;
  covariance << 1e-5, 2e-6, -1e-6, 2e-6, 3e-6, 5e-7, -1e-6, 5e-7, 1e-5;
  Eigen::Matrix<double, 6, 6> s = h * covariance * h.transpose();
  s.diagonal() += variance;
  const Eigen::Matrix<double, 6, 1> innovation = z - h * predicted_;
  EXPECT_NEAR(innovation_chi2(stack, predicted_, covariance),
              innovation.dot(s.inverse() * innovation), 1e-9);
}

TEST_F(LsvJudge, SensorsAtOnePlaceHaveTwoSpeedsInCommon) {
  sensors_ = 0;
  mount({.x_m = 0.2, .y_m = 0.1});
  mount({.x_m = 0.2, .y_m = 0.1, .yaw_rad = 1.0});
  see(predicted_);
  const Parity p = parity(stack_of(readings_, mounts_, {true, true}));
  EXPECT_EQ(p.dof, 2);
  EXPECT_NEAR(p.chi2, 0.0, 1e-9);
}

}  // namespace
}  // namespace lsv::fusion
