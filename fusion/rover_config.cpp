// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/rover_config.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fusion/lsv_rows.h"

namespace lsv {
namespace {

constexpr double kHuge = 1e12;

struct Range {
  double least = 0.0;
  bool is_least_allowed = false;
  double most = kHuge;
};
constexpr Range kPositive{};
constexpr Range kNotNegative{0.0, true, kHuge};
constexpr Range kAnything{-kHuge, true, kHuge};

Result<void> check(const std::string& name, double value, const Range& range) {
  const bool above = range.is_least_allowed ? value >= range.least : value > range.least;
  if (above && value <= range.most) return {};
  return Error{
      ErrorCode::invalid_argument,
      "'" + name + "' is " + std::to_string(value) + ", but must be " +
          (range.least == 0.0 ? (range.is_least_allowed ? "0 or more" : "above 0") : "a number") +
          (range.most < kHuge ? " and at most " + std::to_string(range.most) : "")};
}

struct Named {
  std::string name;
  double value;
  Range range;
};

Result<void> check_all(const std::vector<Named>& all) {
  for (const Named& one : all) {
    if (Result<void> ok = check(one.name, one.value, one.range); !ok) return ok;
  }
  return {};
}

}  // namespace

Result<void> validate(const FusionConfig& config) {
  std::vector<Named> all;
  if (config.wheels) {
    const WheelConfig& wheels = *config.wheels;
    all.push_back({"wheels.radius_m", wheels.radius_m, kPositive});
    all.push_back({"wheels.track_m", wheels.track_m, kPositive});
    all.push_back({"wheels.noise_rad_s", wheels.noise_rad_s, kPositive});
    if (wheels.ticks_per_turn)
      all.push_back({"wheels.ticks_per_turn", *wheels.ticks_per_turn, kPositive});
  }
  if (config.lsv.size() > kMaxLsvSensors) {
    return Error{ErrorCode::invalid_argument, "there are " + std::to_string(config.lsv.size()) +
                                                  " LSV sensors, at most " +
                                                  std::to_string(kMaxLsvSensors) + " are fused"};
  }
  for (std::size_t i = 0; i < config.lsv.size(); ++i) {
    const std::string name = "lsv[" + std::to_string(i) + "].";
    all.push_back({name + "x_m", config.lsv[i].x_m, kAnything});
    all.push_back({name + "y_m", config.lsv[i].y_m, kAnything});
    all.push_back({name + "yaw_rad", config.lsv[i].yaw_rad, kAnything});
    all.push_back({name + "noise_m_s", config.lsv[i].noise_m_s, kPositive});
    all.push_back({name + "sigma_scale_ratio", config.lsv[i].sigma_scale_ratio, {0.0, true, 0.1}});
  }
  if (config.gyro) {
    all.push_back({"imu.gyro_noise_rad_s", config.gyro->noise_rad_s, kPositive});
    all.push_back({"imu.gyro_bias_sigma_rad_s", config.gyro->bias_sigma_rad_s, kNotNegative});
  }
  all.push_back({"start.x_m", config.start.x_m, kAnything});
  all.push_back({"start.y_m", config.start.y_m, kAnything});
  all.push_back({"start.yaw_rad", config.start.yaw_rad, kAnything});
  all.push_back({"start.sigma_m", config.start.sigma_m, kNotNegative});
  all.push_back({"start.sigma_yaw_rad", config.start.sigma_yaw_rad, kNotNegative});
  const MotionConfig& motion = config.motion;
  all.push_back({"motion.vx_walk_m_s", motion.vx_walk_m_s, kPositive});
  all.push_back({"motion.wz_walk_rad_s", motion.wz_walk_rad_s, kPositive});
  all.push_back({"motion.ax_walk_m_s2", motion.ax_walk_m_s2, kPositive});
  all.push_back({"motion.az_walk_rad_s2", motion.az_walk_rad_s2, kPositive});
  all.push_back({"motion.vy_sigma_m_s", motion.vy_sigma_m_s, kNotNegative});
  all.push_back({"motion.vy_time_s", motion.vy_time_s, kPositive});
  all.push_back({"motion.efficiency_sigma_ratio", motion.efficiency_sigma_ratio, kNotNegative});
  all.push_back({"motion.efficiency_time_s", motion.efficiency_time_s, kPositive});
  all.push_back({"slip.alarm_ratio", config.slip.alarm_ratio, {0.0, false, 1.0}});
  all.push_back({"slip.threshold_sigmas", config.slip.threshold_sigmas, kPositive});
  all.push_back({"filter.gate_probability", config.gate_probability, {0.0, false, 0.1}});
  all.push_back({"filter.optical_timeout_s", config.optical_timeout_s, kPositive});
  all.push_back({"filter.same_time_s", config.same_time_s, {0.0, true, 1.0}});
  if (Result<void> ok = check_all(all); !ok) return ok;
  if (config.max_rejected_in_a_row < 1 || config.late_epochs < 1 || config.late_epochs > 65536) {
    return Error{ErrorCode::invalid_argument,
                 "'filter.max_rejected_in_a_row' and 'filter.late_epochs' must be 1 or more, the "
                 "latter at most 65536"};
  }
  if (!config.wheels && config.lsv.empty()) {
    return Error{ErrorCode::invalid_argument,
                 "the rover has neither wheels nor LSV sensors: nothing tells its speed"};
  }
  return {};
}

MountingRank mounting_rank(const std::vector<LsvConfig>& lsv) {
  MountingRank out;
  if (lsv.empty()) return out;
  Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(lsv.size()), 3);
  for (std::size_t i = 0; i < lsv.size(); ++i) {
    rows.middleRows<2>(2 * static_cast<Eigen::Index>(i)) = fusion::lsv_rows(lsv[i]);
    for (std::size_t j = 0; j < i; ++j) {
      out.spread_m =
          std::max(out.spread_m, std::hypot(lsv[i].x_m - lsv[j].x_m, lsv[i].y_m - lsv[j].y_m));
    }
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rows);
  qr.setThreshold(1e-6);
  out.rank = static_cast<int>(qr.rank());
  return out;
}

std::vector<std::string> mounting_warnings(const FusionConfig& config) {
  std::vector<std::string> out;
  const MountingRank mounting = mounting_rank(config.lsv);
  if (!config.lsv.empty() && mounting.rank < 3) {
    std::string line = config.lsv.size() == 1
                           ? "one LSV sensor cannot tell turning from side slip"
                           : "LSV sensors at one place cannot tell turning from side slip";
    if (config.wheels || config.gyro) {
      line += ": the heading rests on ";
      line += config.gyro ? (config.wheels ? "gyro and wheels" : "the gyro") : "the wheels";
    } else {
      line += ": the heading rests on motion.vy_sigma_m_s, the side slip that is taken for likely";
    }
    out.push_back(line);
  }
  return out;
}

}  // namespace lsv
