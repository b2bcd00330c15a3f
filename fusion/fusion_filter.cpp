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
constexpr double kLeastEfficiency = 0.02;
/// Wheels that said nothing for so long say nothing any more.
constexpr double kWheelTimeout_s = 0.5;

void forget(int i, double sigma, StateMatrix& p) {
  p.row(i).setZero();
  p.col(i).setZero();
  p(i, i) = sigma * sigma;
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
  state.x(kLeft) = state.x(kRight) = 1.0;
  state.p(kX, kX) = state.p(kY, kY) = start.sigma_m * start.sigma_m;
  state.p(kYaw, kYaw) = start.sigma_yaw_rad * start.sigma_yaw_rad;
  if (config_.gyro) forget(kBias, config_.gyro->bias_sigma_rad_s, state.p);
  forget(kLeft, config_.motion.efficiency_sigma_ratio, state.p);
  forget(kRight, config_.motion.efficiency_sigma_ratio, state.p);
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

void FusionFilter::forget_grip(int which, FilterState& state) const {
  forget(which, std::max(config_.motion.efficiency_sigma_ratio, 0.5), state.p);
}

void FusionFilter::predict_to(Stamp stamp, FilterState& state) const {
  predict(config_.motion, seconds_between(state.stamp, stamp), state.x, state.p);
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
  const StateVector ph = state.p * row.h;
  const double s = row.h.dot(ph) + row.variance;
  if (!(s > 0.0) || !std::isfinite(s) || !std::isfinite(row.innovation)) {
    ++state.counters.updates_refused;
    return;
  }
  const StateVector gain = ph / s;
  // Joseph: (I - K h') P (I - K h')' + K r K'
  const StateMatrix left = state.p - gain * ph.transpose();
  StateMatrix p = left - (left * row.h) * gain.transpose() + row.variance * gain * gain.transpose();
  p = 0.5 * (p + p.transpose().eval());
  if (!p.allFinite() || !(p.diagonal().array() >= 0.0).all()) {
    ++state.counters.updates_refused;
    return;
  }
  state.p = p;
  state.x += gain * row.innovation;
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

  if (judgement.is_any_believed) {
    state.lsv_epochs_refused = 0;
    if (judgement.is_jump) {
      ++state.counters.velocity_steps;
      forget_motion(state);
    }
  } else if (++state.lsv_epochs_refused > config_.max_rejected_in_a_row) {
    // What is refused again and again is the motion, not an outlier.
    ++state.counters.lsv_streaks_ended;
    state.lsv_epochs_refused = 0;
    forget_motion(state);
    for (std::size_t i = 0; i < there.size(); ++i) {
      if (there[i]) judgement.verdict[i] = LsvVerdict::believed;
    }
    judgement.is_any_believed = true;
  }
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
  if (judgement.is_any_believed) state.last_lsv = state.stamp;
}

void FusionFilter::weigh_gyro(const GyroSample& sample, FilterState& state) const {
  Row row;
  row.h(kWz) = row.h(kBias) = 1.0;
  row.innovation = sample.wz_rad_s - row.h.dot(state.x);
  row.variance = config_.gyro->noise_rad_s * config_.gyro->noise_rad_s;
  const double s = row.h.dot(state.p * row.h) + row.variance;
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

FusionFilter::Row FusionFilter::wheel_row(double rate_rad_s, double variance_rad2_s2, bool is_left,
                                          const FilterState& state) const {
  // 0 = radius rate efficiency - (vx -+ wz track / 2)
  const WheelConfig& wheels = *config_.wheels;
  const int grip = is_left ? kLeft : kRight;
  const double side_m = (is_left ? 0.5 : -0.5) * wheels.track_m;  // y of the wheel
  Row row;
  row.h(kVx) = -1.0;
  row.h(kWz) = side_m;
  row.h(grip) = wheels.radius_m * rate_rad_s;
  row.innovation = -row.h.dot(state.x);
  const double efficiency = std::max(state.x(grip), kLeastEfficiency);
  row.variance = variance_rad2_s2 * wheels.radius_m * wheels.radius_m * efficiency * efficiency;
  return row;
}

void FusionFilter::watch_slip(const WheelSample& sample, double variance_rad2_s2,
                              FilterState& state) const {
  const WheelConfig& wheels = *config_.wheels;
  for (const bool is_left : {true, false}) {
    const double side_m = (is_left ? 0.5 : -0.5) * wheels.track_m;
    const double ground_m_s = state.x(kVx) - state.x(kWz) * side_m;
    const double variance_m2_s2 = state.p(kVx, kVx) - 2.0 * side_m * state.p(kVx, kWz) +
                                  side_m * side_m * state.p(kWz, kWz) +
                                  variance_rad2_s2 * wheels.radius_m * wheels.radius_m;
    const double rate_rad_s = is_left ? sample.left_rad_s : sample.right_rad_s;
    (is_left ? state.left_slip : state.right_slip)
        .add(config_.slip, wheels.radius_m * rate_rad_s, ground_m_s, std::sqrt(variance_m2_s2));
  }
}

void FusionFilter::weigh_wheels(const WheelSample& sample, FilterState& state) const {
  double variance_rad2_s2 = config_.wheels->noise_rad_s * config_.wheels->noise_rad_s;
  if (config_.wheels->ticks_per_turn) {
    // A rate is the difference of two counts, each rounded by up to a tick. How long between is
    // not known of the first.
    const std::optional<Stamp> before = state.last_wheels;
    state.last_wheels = state.stamp;
    if (!before || !(seconds_between(*before, state.stamp) > 0.0)) return;
    const double tick_rad_s = 2.0 * std::numbers::pi / *config_.wheels->ticks_per_turn /
                              seconds_between(*before, state.stamp);
    variance_rad2_s2 += tick_rad_s * tick_rad_s / 6.0;
  }
  state.last_wheels = state.stamp;
  const bool optics = has_optics(state, state.stamp);
  state.is_slip_known = optics;
  if (optics) watch_slip(sample, variance_rad2_s2, state);

  const auto rows = [&] {
    return std::array{wheel_row(sample.left_rad_s, variance_rad2_s2, true, state),
                      wheel_row(sample.right_rad_s, variance_rad2_s2, false, state)};
  };
  const auto chi2 = [&](const std::array<Row, 2>& both) {
    Eigen::Matrix<double, kStates, 2> h;
    h.col(0) = both[0].h;
    h.col(1) = both[1].h;
    Eigen::Matrix2d s = h.transpose() * state.p * h;
    s(0, 0) += both[0].variance;
    s(1, 1) += both[1].variance;
    const Eigen::Vector2d innovation{both[0].innovation, both[1].innovation};
    return innovation.dot(s.inverse() * innovation);
  };
  state.wheel_agreement = {chi2(rows()), 2};
  if (state.wheel_agreement.nis > limits_[2]) {
    if (optics) {  // the motion is known: it is the grip that changed
      ++state.counters.grip_opened;
      const auto both = rows();
      const auto alone = [&](const Row& row) {
        return row.innovation * row.innovation / (row.h.dot(state.p * row.h) + row.variance);
      };
      const bool left = alone(both[0]) > limits_[1], right = alone(both[1]) > limits_[1];
      if (left || !right) forget_grip(kLeft, state);
      if (right || !left) forget_grip(kRight, state);
    } else {
      ++state.counters.wheel_steps;
      forget_motion(state);
    }
  }
  ++state.counters.wheels_accepted;
  update(wheel_row(sample.left_rad_s, variance_rad2_s2, true, state), state);
  update(wheel_row(sample.right_rad_s, variance_rad2_s2, false, state), state);
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
    out.left = {state.x(kLeft), std::sqrt(state.p(kLeft, kLeft)), state.left_slip.alarm(),
                state.is_slip_known};
    out.right = {state.x(kRight), std::sqrt(state.p(kRight, kRight)), state.right_slip.alarm(),
                 state.is_slip_known};
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
