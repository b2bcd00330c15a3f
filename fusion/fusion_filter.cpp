// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/fusion_filter.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "fusion/chi_square.h"

namespace lsv::fusion {
namespace {

constexpr double kUnknownSpeed_m_s = 1.0;
constexpr double kUnknownRate_rad_s = 1.0;
constexpr double kUnknownAcceleration_m_s2 = 1.0;
/// Of the efficiency of a wheel that contradicts the motion.
constexpr double kUnknownGrip = 0.5;
/// A rim speed that differs by more was commanded otherwise; less than that it is at rest.
constexpr double kRimSigmas = 5.0;
constexpr double kRimSmoothing = 0.1;
/// Wheels that said nothing for so long say nothing any more.
constexpr double kWheelTimeout_s = 0.5;

void forget(int i, double sigma, StateMatrix& p) {
  p.row(i).setZero();
  p.col(i).setZero();
  p(i, i) = sigma * sigma;
}

/// A row of a sensor is empty but for two or three places.
StateVector times(const StateMatrix& p, const StateVector& h) {
  StateVector out = StateVector::Zero();
  for (int i = 0; i < kStates; ++i) {
    if (h(i) != 0.0) out += h(i) * p.col(i);
  }
  return out;
}

}  // namespace

FusionFilter::FusionFilter(const FusionConfig& config) : config_(config) {
  for (std::size_t i = 0; i < config_.lsv.size(); ++i) mounts_[i] = lsv_rows(config_.lsv[i]);
  for (std::size_t dof = 1; dof < limits_.size(); ++dof) {
    limits_[dof] = chi_square_limit(config_.gate_probability, static_cast<int>(dof));
  }
}

FilterState FusionFilter::start_at(Stamp stamp) const {
  FilterState state;
  state.stamp = state.start = stamp;
  const StartConfig& start = config_.start;
  state.x(kX) = start.x_m;
  state.x(kY) = start.y_m;
  state.x(kYaw) = start.yaw_rad;
  state.p(kX, kX) = state.p(kY, kY) = start.sigma_m * start.sigma_m;
  state.p(kYaw, kYaw) = start.sigma_yaw_rad * start.sigma_yaw_rad;
  if (config_.gyro) forget(kBias, config_.gyro->bias_sigma_rad_s, state.p);
  forget_motion(state);
  return state;
}

void FusionFilter::forget_motion(FilterState& state) const {
  forget(kVx, kUnknownSpeed_m_s, state.p);
  forget(kWz, kUnknownRate_rad_s, state.p);
  forget(kVy, config_.motion.vy_sigma_m_s, state.p);
  if (config_.motion.model == MotionModel::constant_acceleration) {
    forget(kAx, kUnknownAcceleration_m_s2, state.p);
    forget(kAz, kUnknownAcceleration_m_s2, state.p);
  }
}

void FusionFilter::forget_grip(bool is_left, FilterState& state) const {
  const double rim_m_s = (is_left ? state.left : state.right).rim_m_s;
  const double sigma_ratio = std::max(config_.motion.efficiency_sigma_ratio, kUnknownGrip);
  forget(is_left ? kLeft : kRight, sigma_ratio * std::abs(rim_m_s), state.p);
}

void FusionFilter::predict_to(Stamp stamp, FilterState& state) const {
  const double sigma_ratio = config_.motion.efficiency_sigma_ratio;
  predict(config_.motion,
          {sigma_ratio * std::abs(state.left.rim_m_s), sigma_ratio * std::abs(state.right.rim_m_s)},
          seconds_between(state.stamp, stamp), state.x, state.p);
  state.stamp = stamp;
}

void FusionFilter::process(const Epoch& epoch, FilterState& state) const {
  predict_to(epoch.stamp, state);
  state.lsv_agreement = state.wheel_agreement = state.gyro_agreement = {};
  state.lsv_refused.fill(false);
  state.lsv_nis.fill(kUnknown);
  weigh_lsv(epoch.lsv, state);
  if (epoch.gyro) weigh_gyro(*epoch.gyro, state);
  if (epoch.wheels) weigh_wheels(*epoch.wheels, state);
  if (epoch.standstill) stand_still(*epoch.standstill, state);
}

void FusionFilter::update(const Row& row, FilterState& state) {
  const StateVector ph = times(state.p, row.h);
  const double s = row.h.dot(ph) + row.variance;
  bool is_sound = s > 0.0 && std::isfinite(s) && std::isfinite(row.innovation);
  // Joseph, (I - K h') P (I - K h')' + r K K', multiplied out: P + K c' + c K'.
  const StateVector gain = ph / s;
  const StateVector c = 0.5 * s * gain - ph;
  for (int i = 0; i < kStates; ++i) {
    const double variance = state.p(i, i) + 2.0 * gain(i) * c(i);
    is_sound = is_sound && variance >= 0.0 && std::isfinite(variance);
  }
  if (!is_sound) {
    ++state.counters.updates_refused;
    return;
  }
  for (int i = 0; i < kStates; ++i) state.p.col(i) += c(i) * gain + gain(i) * c;
  state.x += gain * row.innovation;
}

/// The motion changed from one sample to the next, nobody knows when: on average half way, so that
/// half of the change was missed; with the scatter of a time that is anywhere in between.
void FusionFilter::jump_in_between(const Eigen::Vector3d& motion_before, double dt_s,
                                   FilterState& state) {
  const Eigen::Vector3d missed = (state.x.segment<3>(kVx) - motion_before) * dt_s;
  const double c = std::cos(state.x(kYaw)), s = std::sin(state.x(kYaw));
  const Eigen::Vector3d way{c * missed.x() - s * missed.y(), s * missed.x() + c * missed.y(),
                            missed.z()};
  state.x.head<3>() += 0.5 * way;
  state.p.topLeftCorner<3, 3>() += way * way.transpose() / 12.0;
}

void FusionFilter::weigh_lsv(const LsvReadings& readings, FilterState& state) const {
  const Eigen::Vector3d motion = state.x.segment<3>(kVx);
  const Eigen::Matrix3d covariance = state.p.block<3, 3>(kVx, kVx);
  LsvJudgement judgement =
      judge(readings, mounts_, limits_, motion, covariance, state.was_odd_in_agreement);

  std::array<bool, kMaxLsvSensors> there{};
  for (std::size_t i = 0; i < readings.size(); ++i) {
    there[i] = readings[i].is_there;
    if (!there[i]) continue;
    std::array<bool, kMaxLsvSensors> alone{};
    alone[i] = true;
    state.lsv_nis[i] = innovation_chi2(stack_of(readings, mounts_, alone), motion, covariance);
  }
  const LsvStack stack = stack_of(readings, mounts_, there);
  if (stack.rows == 0) return;
  state.was_odd_in_agreement = judgement.is_odd_in_agreement;
  state.lsv_agreement = {innovation_chi2(stack, motion, covariance), stack.rows};

  bool is_forgotten = false;
  if (judgement.is_any_believed) {
    state.lsv_epochs_refused = 0;
    if (judgement.is_jump) {
      ++state.counters.velocity_steps;
      is_forgotten = true;
    }
  } else if (++state.lsv_epochs_refused > config_.max_rejected_in_a_row) {
    // What is refused again and again is the motion, not an outlier.
    ++state.counters.lsv_streaks_ended;
    state.lsv_epochs_refused = 0;
    is_forgotten = true;
    for (std::size_t i = 0; i < there.size(); ++i) {
      if (there[i]) judgement.verdict[i] = LsvVerdict::believed;
    }
    judgement.is_any_believed = true;
  }
  if (is_forgotten) forget_motion(state);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    switch (judgement.verdict[i]) {
      case LsvVerdict::absent:
        break;
      case LsvVerdict::refused_by_parity:
        ++state.counters.lsv_refused_by_parity;
        state.lsv_refused[i] = true;
        break;
      case LsvVerdict::refused_by_innovation:
        ++state.counters.lsv_refused_by_innovation;
        state.lsv_refused[i] = true;
        break;
      case LsvVerdict::believed:
        ++state.counters.lsv_accepted;
        for (int axis = 0; axis < 2; ++axis) {
          Row row;
          row.h.segment<3>(kVx) = mounts_[i].row(axis).transpose();
          row.innovation = readings[i].v_m_s(axis) - row.h.dot(state.x);
          row.variance = readings[i].variance_m2_s2(axis);
          update(row, state);
        }
        break;
    }
  }
  if (is_forgotten && state.last_lsv)
    jump_in_between(motion, seconds_between(*state.last_lsv, state.stamp), state);
  if (judgement.is_any_believed) state.last_lsv = state.stamp;
}

void FusionFilter::weigh_gyro(const GyroSample& sample, FilterState& state) const {
  Row row;
  row.h(kWz) = row.h(kBias) = 1.0;
  row.innovation = sample.wz_rad_s - row.h.dot(state.x);
  row.variance = config_.gyro->noise_rad_s * config_.gyro->noise_rad_s;
  const double s = row.h.dot(times(state.p, row.h)) + row.variance;
  state.gyro_agreement = {row.innovation * row.innovation / s, 1};
  if (state.gyro_agreement.nis > limits_[1]) {
    ++state.counters.gyro_refused;
    return;
  }
  ++state.counters.gyro_accepted;
  update(row, state);
}

void FusionFilter::stand_still(const StandstillSample& sample, FilterState& state) const {
  ++state.counters.standstills;
  for (const int i : {static_cast<int>(kVx), static_cast<int>(kVy), static_cast<int>(kWz)}) {
    Row row;
    row.h(i) = 1.0;
    row.innovation = -state.x(i);
    const double sigma = i == kWz ? sample.sigma_rad_s : sample.sigma_m_s;
    row.variance = sigma * sigma;
    update(row, state);
  }
}

FusionFilter::Row FusionFilter::wheel_row(double rim_m_s, double variance_m2_s2, bool is_left,
                                          const FilterState& state) const {
  // rim speed = vx - wz y + slip speed, with the wheel at y
  const double y_m = (is_left ? 0.5 : -0.5) * config_.wheels->track_m;
  Row row;
  row.h(kVx) = 1.0;
  row.h(kWz) = -y_m;
  row.h(is_left ? kLeft : kRight) = 1.0;
  row.innovation = rim_m_s - row.h.dot(state.x);
  row.variance = variance_m2_s2;
  return row;
}

/// A wheel that turns otherwise slips in proportion; one that begins to turn may slip anyhow.
void FusionFilter::follow_rim(double rim_m_s, double variance_m2_s2, bool is_left,
                              FilterState& state) const {
  const int slip = is_left ? kLeft : kRight;
  double& usual_m_s = (is_left ? state.left : state.right).rim_m_s;
  const double limit_m_s = kRimSigmas * std::sqrt(variance_m2_s2);
  if (std::abs(rim_m_s - usual_m_s) <= limit_m_s) {
    usual_m_s += kRimSmoothing * (rim_m_s - usual_m_s);
    return;
  }
  if (std::abs(usual_m_s) > limit_m_s) {
    const double ratio = rim_m_s / usual_m_s;
    state.x(slip) *= ratio;
    state.p.row(slip) *= ratio;
    state.p.col(slip) *= ratio;
  } else {
    state.x(slip) = 0.0;
    forget(slip, config_.motion.efficiency_sigma_ratio * std::abs(rim_m_s), state.p);
  }
  usual_m_s = rim_m_s;
}

void FusionFilter::watch_slip(double rim_m_s, double variance_m2_s2, bool is_left,
                              FilterState& state) const {
  const double y_m = (is_left ? 0.5 : -0.5) * config_.wheels->track_m;
  const double ground_m_s = state.x(kVx) - state.x(kWz) * y_m;
  const double ground_variance_m2_s2 =
      state.p(kVx, kVx) - 2.0 * y_m * state.p(kVx, kWz) + y_m * y_m * state.p(kWz, kWz);
  (is_left ? state.left : state.right)
      .cusum.add(config_.slip, rim_m_s, ground_m_s,
                 std::sqrt(ground_variance_m2_s2 + variance_m2_s2));
}

void FusionFilter::weigh_wheels(const WheelSample& sample, FilterState& state) const {
  double variance_rad2_s2 = config_.wheels->noise_rad_s * config_.wheels->noise_rad_s;
  const std::optional<Stamp> before = state.last_wheels;
  state.last_wheels = state.stamp;
  if (config_.wheels->ticks_per_turn) {
    // A rate is the difference of two counts, each rounded by up to a tick. How long between is
    // not known of the first.
    if (!before || !(seconds_between(*before, state.stamp) > 0.0)) return;
    const double tick_rad_s = 2.0 * std::numbers::pi / *config_.wheels->ticks_per_turn /
                              seconds_between(*before, state.stamp);
    variance_rad2_s2 += tick_rad_s * tick_rad_s / 6.0;
  }
  const double radius_m = config_.wheels->radius_m;
  const double variance_m2_s2 = radius_m * radius_m * variance_rad2_s2;
  const double rim_m_s[] = {radius_m * sample.left_rad_s, radius_m * sample.right_rad_s};
  const bool optics = has_optics(state, state.stamp);
  state.is_slip_known = optics;
  for (const bool is_left : {true, false}) {
    follow_rim(rim_m_s[is_left ? 0 : 1], variance_m2_s2, is_left, state);
    if (optics) watch_slip(rim_m_s[is_left ? 0 : 1], variance_m2_s2, is_left, state);
  }

  const std::array both{wheel_row(rim_m_s[0], variance_m2_s2, true, state),
                        wheel_row(rim_m_s[1], variance_m2_s2, false, state)};
  const StateVector ph[] = {times(state.p, both[0].h), times(state.p, both[1].h)};
  Eigen::Matrix2d s;
  s << both[0].h.dot(ph[0]), both[0].h.dot(ph[1]), both[1].h.dot(ph[0]), both[1].h.dot(ph[1]);
  s.diagonal().array() += variance_m2_s2;
  const Eigen::Vector2d innovation{both[0].innovation, both[1].innovation};
  state.wheel_agreement = {innovation.dot(s.inverse() * innovation), 2};
  if (state.wheel_agreement.nis > limits_[2]) {
    if (optics) {  // the motion is known: it is the grip that changed
      ++state.counters.grip_opened;
      const bool left = innovation(0) * innovation(0) / s(0, 0) > limits_[1];
      const bool right = innovation(1) * innovation(1) / s(1, 1) > limits_[1];
      if (left || !right) forget_grip(true, state);
      if (right || !left) forget_grip(false, state);
    } else {
      ++state.counters.wheel_steps;
      forget_motion(state);
    }
  }
  ++state.counters.wheels_accepted;
  update(wheel_row(rim_m_s[0], variance_m2_s2, true, state), state);
  update(wheel_row(rim_m_s[1], variance_m2_s2, false, state), state);
}

WheelGrip FusionFilter::grip(bool is_left, const FilterState& state) const {
  const WheelMemory& wheel = is_left ? state.left : state.right;
  const int slip = is_left ? kLeft : kRight;
  WheelGrip out{.is_slipping = wheel.cusum.alarm(), .is_slip_known = state.is_slip_known};
  // Of a wheel that hardly turns there is no ratio.
  const double least_m_s = kRimSigmas * config_.wheels->radius_m * config_.wheels->noise_rad_s;
  if (!(std::abs(wheel.rim_m_s) > least_m_s)) return out;
  out.efficiency_ratio = 1.0 - state.x(slip) / wheel.rim_m_s;
  out.sigma_ratio = std::sqrt(state.p(slip, slip)) / std::abs(wheel.rim_m_s);
  return out;
}

bool FusionFilter::has_optics(const FilterState& state, Stamp now) const {
  return state.last_lsv && seconds_between(*state.last_lsv, now) <= config_.optical_timeout_s;
}

bool FusionFilter::has_wheels(const FilterState& state, Stamp now) const {
  return state.last_wheels && seconds_between(*state.last_wheels, now) <= kWheelTimeout_s;
}

NavState FusionFilter::describe(const FilterState& state, Stamp now) const {
  NavState out;
  out.stamp = state.stamp;
  if (has_optics(state, now)) {
    out.status = NavStatus::ok;
  } else if (has_wheels(state, now)) {
    out.status = config_.lsv.empty() ? NavStatus::ok : NavStatus::optical_lost;
  } else {
    out.status = NavStatus::no_motion_source;
  }
  out.x_m = state.x(kX);
  out.y_m = state.x(kY);
  out.yaw_rad = state.x(kYaw);
  out.vx_m_s = state.x(kVx);
  out.vy_m_s = state.x(kVy);
  out.wz_rad_s = state.x(kWz);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      out.cov[i][j] = state.p(static_cast<int>(i), static_cast<int>(j));
    }
  }
  if (config_.wheels) {
    out.left = grip(true, state);
    out.right = grip(false, state);
  }
  if (config_.gyro) out.gyro_bias_rad_s = state.x(kBias);
  out.lsv = state.lsv_agreement;
  out.wheels = state.wheel_agreement;
  out.gyro = state.gyro_agreement;
  out.lsv_refused = state.lsv_refused;
  out.lsv_nis = state.lsv_nis;
  return out;
}

}  // namespace lsv::fusion
