// SPDX-License-Identifier: BSD-3-Clause
#include "sim/rover_drive.h"

#include <algorithm>
#include <cmath>

#include "sim/philox.h"

namespace lsv::sim {
namespace {

/// What the random numbers of one step are for.
enum Draw : std::int64_t { along, turning, sideways, left_grip, right_grip };

class Driver {
 public:
  explicit Driver(const RoverPlan& plan) : plan_(plan) {
    state_.x_m = plan.start_x_m;
    state_.y_m = plan.start_y_m;
    state_.yaw_rad = plan.start_yaw_rad;
    if (plan.random) state_.vx_m_s = plan.random->vx_m_s;
  }

  std::vector<RoverState> run() {
    const auto step_ns = static_cast<std::int64_t>(std::llround(plan_.step_s * 1e9));
    std::vector<RoverState> out;
    out.reserve(static_cast<std::size_t>(plan_.steps) + 1);
    for (int k = 0; k <= plan_.steps; ++k) {
      state_.time_ns = k * step_ns;
      if (plan_.random)
        follow_wheels();
      else
        obey(k);
      out.push_back(state_);
      if (plan_.random)
        wander(k);
      else
        move(state_.vx_m_s, state_.vy_m_s, state_.wz_rad_s);
    }
    return out;
  }

 private:
  double time_s() const { return static_cast<double>(state_.time_ns) * 1e-9; }

  /// Wheels as commanded, on the ground that they stand on.
  void obey(int k) {
    const WheelCommand now = command();
    state_.left_rad_s = now.left_rad_s;
    state_.right_rad_s = now.right_rad_s;
    grip(true, k, state_.left_efficiency_ratio);
    grip(false, k, state_.right_efficiency_ratio);
    const double left_m_s = plan_.radius_m * now.left_rad_s * state_.left_efficiency_ratio;
    const double right_m_s = plan_.radius_m * now.right_rad_s * state_.right_efficiency_ratio;
    state_.vx_m_s = 0.5 * (left_m_s + right_m_s);
    state_.wz_rad_s = (right_m_s - left_m_s) / plan_.track_m;
    state_.vy_m_s = 0.0;
    for (const SideSlip& slip : plan_.side_slips) {
      if (time_s() >= slip.begin_s && time_s() < slip.end_s) state_.vy_m_s = slip.vy_m_s;
    }
  }

  WheelCommand command() const {
    double end_s = 0.0;
    for (const WheelCommand& one : plan_.commands) {
      end_s += one.duration_s;
      if (time_s() < end_s - 1e-9) return one;
    }
    return {};
  }

  void grip(bool is_left, int k, double& efficiency_ratio) const {
    const double side_m = (is_left ? 0.5 : -0.5) * plan_.track_m;
    const double x_m = state_.x_m - side_m * std::sin(state_.yaw_rad);
    const double y_m = state_.y_m + side_m * std::cos(state_.yaw_rad);
    double target = 1.0;
    for (const SoilPatch& patch : plan_.patches) {
      if (x_m > patch.left_m && x_m < patch.right_m && y_m > patch.bottom_m && y_m < patch.top_m) {
        target = patch.efficiency_ratio;
        break;
      }
    }
    const double most = plan_.ramp_s > 0.0 && k > 0 ? 0.5 * plan_.step_s / plan_.ramp_s : 1.0;
    efficiency_ratio += std::clamp(target - efficiency_ratio, -most, most);
  }

  void move(double vx_m_s, double vy_m_s, double wz_rad_s) {
    const double dt_s = plan_.step_s;
    const double turn_rad = wz_rad_s * dt_s;
    double along = 1.0, across = 0.0;  // of a way of 1 along an arc
    if (plan_.integrator == RoverIntegrator::exact) {
      const double half = 0.5 * turn_rad;
      // 2 sin^2 (t/2) = 1 - cos t, without cancellation
      along = std::abs(turn_rad) < 1e-7 ? 1.0 : std::sin(turn_rad) / turn_rad;
      across = std::abs(turn_rad) < 1e-7 ? half : 2.0 * std::sin(half) * std::sin(half) / turn_rad;
    }
    const double forward_m = dt_s * (vx_m_s * along - vy_m_s * across);
    const double left_m = dt_s * (vx_m_s * across + vy_m_s * along);
    const double c = std::cos(state_.yaw_rad), s = std::sin(state_.yaw_rad);
    state_.x_m += c * forward_m - s * left_m;
    state_.y_m += s * forward_m + c * left_m;
    state_.yaw_rad += turn_rad;
  }

  /// Wheels that turn as the motion and their grip make them.
  void follow_wheels() {
    const double side_m_s = 0.5 * plan_.track_m * state_.wz_rad_s;
    state_.left_rad_s =
        (state_.vx_m_s - side_m_s) / (plan_.radius_m * state_.left_efficiency_ratio);
    state_.right_rad_s =
        (state_.vx_m_s + side_m_s) / (plan_.radius_m * state_.right_efficiency_ratio);
  }

  double normal(int k, Draw draw, int which) const {
    const std::complex<double> z =
        complex_normal(plan_.seed, Stream::rover_drive, k, draw, which / 2);
    return std::sqrt(2.0) * (which % 2 == 0 ? z.real() : z.imag());
  }

  /// A Brownian speed: its change over the step, and its mean, which scatters by itself.
  double walk(int k, Draw draw, double walk_per_root_s, double& speed) const {
    const double root_s = std::sqrt(plan_.step_s);
    const double change = walk_per_root_s * root_s * normal(k, draw, 0);
    const double mean =
        speed + 0.5 * change + walk_per_root_s * root_s / std::sqrt(12.0) * normal(k, draw, 1);
    speed += change;
    return mean;
  }

  void gauss_markov(int k, Draw draw, double sigma, double time_const_s, double& value) const {
    const double keep = std::exp(-plan_.step_s / time_const_s);
    value = keep * value + sigma * std::sqrt(1.0 - keep * keep) * normal(k, draw, 0);
  }

  void wander(int k) {
    const RandomDrive& random = *plan_.random;
    const double vx_m_s = walk(k, along, random.vx_walk_m_s, state_.vx_m_s);
    const double wz_rad_s = walk(k, turning, random.wz_walk_rad_s, state_.wz_rad_s);
    const double vy_before_m_s = state_.vy_m_s;
    gauss_markov(k, sideways, random.vy_sigma_m_s, random.vy_time_s, state_.vy_m_s);
    double left = state_.left_efficiency_ratio - 1.0, right = state_.right_efficiency_ratio - 1.0;
    gauss_markov(k, left_grip, random.efficiency_sigma_ratio, random.efficiency_time_s, left);
    gauss_markov(k, right_grip, random.efficiency_sigma_ratio, random.efficiency_time_s, right);
    move(vx_m_s, 0.5 * (vy_before_m_s + state_.vy_m_s), wz_rad_s);
    // Wheels that hardly grip would have to turn at any rate.
    constexpr double kLeast = 0.2;
    state_.left_efficiency_ratio = std::max(kLeast, 1.0 + left);
    state_.right_efficiency_ratio = std::max(kLeast, 1.0 + right);
  }

  const RoverPlan& plan_;
  RoverState state_;
};

}  // namespace

std::optional<double> soil_efficiency(const std::string& soil) {
  constexpr std::pair<const char*, double> kSoils[] = {
      {"A", 1.0}, {"B", 0.8}, {"C", 0.6}, {"D", 0.5}, {"E", 0.4}};
  for (const auto& [name, efficiency] : kSoils) {
    if (soil == name) return efficiency;
  }
  return std::nullopt;
}

std::vector<RoverState> drive_rover(const RoverPlan& plan) { return Driver(plan).run(); }

}  // namespace lsv::sim
