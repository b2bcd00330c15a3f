// SPDX-License-Identifier: BSD-3-Clause
// Which of the LSV readings of one time are believed. First the sensors against each other (parity:
// a rigid body has three speeds, two sensors give four figures), then against the prediction. A
// jump that all sensors tell alike is a jump of the rover, and is never refused.
//
//   agree with each other, and with the prediction   all are believed
//   agree with each other, not with the prediction   the odd one is refused when all others fit the
//                                                    prediction; else, or when it is so twice in
//                                                    a row, the rover jumped
//   contradict each other                            the one is refused without which the rest
//                                                    fits; else all are
//
// Internal to fusion/. No allocation.
#pragma once

#include <array>
#include <cstddef>

#include "fusion/lsv_rows.h"
#include "fusion/rover_config.h"

namespace lsv::fusion {

/// One reading, in the axes of its sensor.
struct LsvReading {
  bool is_there = false;
  Eigen::Vector2d v_m_s = Eigen::Vector2d::Zero();
  Eigen::Vector2d variance_m2_s2 = Eigen::Vector2d::Zero();
};
using LsvReadings = std::array<LsvReading, kMaxLsvSensors>;
using LsvMounts = std::array<LsvRows, kMaxLsvSensors>;
/// Chi-square limits by degrees of freedom.
using GateLimits = std::array<double, kMostRows + 1>;

enum class LsvVerdict { absent, believed, refused_by_parity, refused_by_innovation };

struct LsvJudgement {
  std::array<LsvVerdict, kMaxLsvSensors> verdict{};
  bool is_jump = false;  // believe them after taking the motion as unknown
  bool is_odd_in_agreement = false;
  bool is_any_believed = false;
};

/// `was_odd_in_agreement`: the judgement before said so.
LsvJudgement judge(const LsvReadings& readings, const LsvMounts& mounts, const GateLimits& limits,
                   const Eigen::Vector3d& motion, const Eigen::Matrix3d& covariance,
                   bool was_odd_in_agreement);

LsvStack stack_of(const LsvReadings& readings, const LsvMounts& mounts,
                  const std::array<bool, kMaxLsvSensors>& which);

}  // namespace lsv::fusion
