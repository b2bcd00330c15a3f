// SPDX-License-Identifier: BSD-3-Clause
// The extended Kalman filter, from one sample time to the next: predict, then weigh what came at
// this time. All that it knows is in FilterState, a plain value, so that time can be gone back to
// by keeping copies. Updates are row by row in Joseph form; one that would leave a covariance that
// is none is not made. Internal to fusion/. No allocation.
#pragma once

#include <optional>

#include "fusion/lsv_judge.h"
#include "fusion/motion_model.h"
#include "fusion/nav_state.h"
#include "fusion/rover_config.h"
#include "fusion/samples.h"
#include "fusion/slip_cusum.h"

namespace lsv::fusion {

/// What came at one time.
struct Epoch {
  Stamp stamp{};
  LsvReadings lsv{};
  std::optional<WheelSample> wheels{};
  std::optional<GyroSample> gyro{};
  std::optional<StandstillSample> standstill{};
};

/// Of one wheel, besides its slip speed in the state.
struct WheelMemory {
  double rim_m_s = 0.0;  // as it turns lately, by the encoder
  SlipCusum spins{};     // faster than the ground passes
  SlipCusum skids{};     // slower
};

struct FilterState {
  Stamp stamp{};
  StateVector x = StateVector::Zero();
  StateMatrix p = StateMatrix::Zero();
  Stamp start{};
  double path_m = 0.0;
  std::optional<Stamp> last_lsv{};  // accepted
  std::optional<Stamp> last_wheels{};
  std::optional<Stamp> last_gyro{};  // accepted
  int lsv_epochs_refused = 0;        // in a row
  bool was_odd_in_agreement = false;
  WheelMemory left{};
  WheelMemory right{};
  bool is_slip_known = false;
  Agreement lsv_agreement{};  // of this time
  Agreement wheel_agreement{};
  Agreement gyro_agreement{};
  std::array<bool, kMaxLsvSensors> lsv_refused{};
  std::array<double, kMaxLsvSensors> lsv_nis{};
  FusionCounters counters{};
};

class FusionFilter {
 public:
  explicit FusionFilter(const FusionConfig& config);

  const FusionConfig& config() const { return config_; }
  FilterState start_at(Stamp stamp) const;
  /// `epoch.stamp` is not before `state.stamp`.
  void process(const Epoch& epoch, FilterState& state) const;
  void predict_to(Stamp stamp, FilterState& state) const;
  /// As the user sees it at `now`.
  NavState describe(const FilterState& state, Stamp now) const;

 private:
  struct Row {
    StateVector h = StateVector::Zero();
    double innovation = 0.0;
    double variance = 0.0;
  };
  void weigh_lsv(const LsvReadings& readings, FilterState& state) const;
  void weigh_wheels(const WheelSample& sample, FilterState& state) const;
  void weigh_gyro(const GyroSample& sample, FilterState& state) const;
  void stand_still(const StandstillSample& sample, FilterState& state) const;
  Row wheel_row(double rim_m_s, double variance_m2_s2, bool is_left,
                const FilterState& state) const;
  void follow_rim(double rim_m_s, double variance_m2_s2, bool is_left, FilterState& state) const;
  void watch_slip(double rim_m_s, double variance_m2_s2, bool is_left, FilterState& state) const;
  void forget_motion(FilterState& state) const;
  static void jump_in_between(const Eigen::Vector3d& motion_before, double dt_s,
                              FilterState& state);
  static double slip_scale_m_s(bool is_left, const FilterState& state);
  static void forget_grip(bool is_left, double innovation_m_s, FilterState& state);
  WheelGrip grip(bool is_left, const FilterState& state) const;
  static void update(const Row& row, FilterState& state);
  bool has_optics(const FilterState& state, Stamp now) const;
  static bool has_wheels(const FilterState& state, Stamp now);
  HeadingSource heading(const FilterState& state, Stamp now) const;

  FusionConfig config_;
  LsvMounts mounts_{};
  GateLimits limits_{};
  std::array<bool, 1U << kMaxLsvSensors> fixes_heading_{};  // by the set of sensors, as bits
};

}  // namespace lsv::fusion
