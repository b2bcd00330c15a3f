// SPDX-License-Identifier: BSD-3-Clause
// The second facade of lsv: samples of LSV sensors, wheels and gyro in, pose, velocity and grip of
// the wheels with covariance out. An extended Kalman filter over
//   x, y, yaw, vx, vy, wz, slip speed left and right, gyro bias (, acceleration, yaw acceleration)
// with exact arcs between samples. Derivation, gates and their limits: docs/fusion.md.
//
// Samples may come in any order: those of one time (FusionConfig::same_time_s) are weighed
// together, and a late one is put where it belongs and all after it is computed again, so that the
// result does not depend on the order of arrival.
//
// Allocates at construction only. One thread at a time. Cost: docs/fusion.md.
#pragma once

#include <cstddef>
#include <memory>

#include "fusion/nav_state.h"
#include "fusion/rover_config.h"
#include "fusion/samples.h"
#include "lsv/core/result.h"

namespace lsv {

class Navigator {
 public:
  static Result<Navigator> create(const FusionConfig& config);
  Navigator(Navigator&&) noexcept;
  Navigator& operator=(Navigator&&) noexcept;
  ~Navigator();

  /// `sensor`: index into FusionConfig::lsv.
  SampleStatus add(std::size_t sensor, const LsvSample& sample);
  SampleStatus add(const WheelSample& sample);
  SampleStatus add(const GyroSample& sample);
  SampleStatus add(const StandstillSample& sample);

  /// At the newest stamp.
  NavState state() const;
  /// Predicted to a later time; at an earlier one it is state().
  NavState state_at(Stamp stamp) const;
  FusionCounters counters() const;

 private:
  struct Impl;
  explicit Navigator(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lsv
