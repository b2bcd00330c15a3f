// SPDX-License-Identifier: BSD-3-Clause
// From pixels to pose: a rover drives and turns over simulated ground with a patch of sand, two LSV
// cameras look at it, lsv::Odometer measures their frames, lsv::Navigator makes of it and of the
// encoders where the rover is. LSV_FULL_DRIVE=1 drives the whole square of 20 s instead of the
// piece of it that holds everything.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "fusion/navigator.h"
#include "lsv/odometer.h"
#include "sim/rover_drive.h"
#include "sim/rover_sensors.h"
#include "sim/turning_speckle.h"

namespace lsv {
namespace {

using std::numbers::pi;

constexpr double kEncoderNoise_rad_s = 0.017;
constexpr double kRate_Hz = 1000.0;
constexpr double kWheelRadius_m = 0.1;
constexpr double kTrack_m = 0.4;

const sim::WheelCommand kSide{2.0, 0.55, 0.55};
const sim::WheelCommand kCorner{3.0, -pi / 3.0, pi / 3.0};

sim::RoverPlan square_with_sand() {
  sim::RoverPlan plan{.radius_m = kWheelRadius_m,
                      .track_m = kTrack_m,
                      .step_s = 1.0 / kRate_Hz,
                      .steps = 20'000,
                      .patches = {{0.2, 0.5, 0.02, 0.09, 0.5}}};
  for (int side = 0; side < 4; ++side) {
    plan.commands.push_back(kSide);
    plan.commands.push_back(kCorner);
  }
  return plan;
}

/// Into the sand with the right wheel, and out of it, then on the spot.
sim::RoverPlan piece_with_sand() {
  sim::RoverPlan plan = square_with_sand();
  plan.start_x_m = 0.11;
  plan.start_y_m = 0.0;
  plan.start_yaw_rad = pi / 2.0;
  plan.steps = 1600;
  // Speeds that jump between two frames cost half an interval of way, which no sigma tells.
  constexpr int kRamp = 100;
  plan.commands.clear();
  for (int k = 0; k < kRamp; ++k)
    plan.commands.push_back({1e-3, 0.55 * k / kRamp, 0.55 * k / kRamp});
  plan.commands.push_back({0.9, 0.55, 0.55});
  for (int k = 0; k < kRamp; ++k) {
    const double part = static_cast<double>(k) / kRamp;
    plan.commands.push_back(
        {1e-3, 0.55 + (-pi / 3.0 - 0.55) * part, 0.55 + (pi / 3.0 - 0.55) * part});
  }
  plan.commands.push_back({0.5, -pi / 3.0, pi / 3.0});
  plan.patches[0].top_m = 0.04;
  return plan;
}

const std::array<sim::SensorPlace, 2> kPlaces{
    {{.x_m = 0.12, .y_m = 0.0}, {.x_m = -0.05, .y_m = 0.10}}};

FusionConfig rover(const sim::RoverPlan& plan) {
  FusionConfig config;
  config.wheels = WheelConfig{kWheelRadius_m, kTrack_m, kEncoderNoise_rad_s, {}};
  for (const sim::SensorPlace& place : kPlaces)
    config.lsv.push_back({"", place.x_m, place.y_m, place.yaw_rad, 5e-5});
  config.start = {.x_m = plan.start_x_m, .y_m = plan.start_y_m, .yaw_rad = plan.start_yaw_rad};
  // A rover that starts to turn within a tenth of a second.
  config.motion.vx_walk_m_s = 0.05;
  config.motion.wz_walk_rad_s = 0.3;
  return config;
}

/// One LSV sensor: the ground under it, its camera, its odometer.
class Lsv {
 public:
  Lsv(const sim::SensorPlace& place, std::uint64_t seed)
      : place_(place),
        camera_(sim::TurningSpeckleCamera::create({.seed = seed}).value()),
        odometer_(Odometer::create(settings(), {.width_px = 128, .height_px = 128}).value()) {}

  StepReport look(std::int64_t frame, const sim::RoverState& state) {
    const double c = std::cos(state.yaw_rad), s = std::sin(state.yaw_rad);
    const sim::SensorPose pose{state.x_m + c * place_.x_m - s * place_.y_m,
                               state.y_m + s * place_.x_m + c * place_.y_m,
                               state.yaw_rad + place_.yaw_rad};
    const auto start = std::chrono::steady_clock::now();
    EXPECT_TRUE(camera_.render(frame, pose, image_));
    render_s += seconds_since(start);
    const auto middle = std::chrono::steady_clock::now();
    const StepReport report = odometer_.push(image_.view()).value();
    track_s += seconds_since(middle);
    return report;
  }

  double render_s = 0.0;
  double track_s = 0.0;

 private:
  static double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  static TrackConfig settings() {
    TrackConfig out;
    out.calibration.pixel_pitch_x_m = out.calibration.pixel_pitch_y_m = 14e-6;
    out.calibration.sc_x_ratio = out.calibration.sc_y_ratio = 2.0;
    out.calibration.noise_mean_counts = 3.0;
    out.calibration.noise_sd_counts = 0.5;
    return out;
  }

  sim::SensorPlace place_;
  sim::TurningSpeckleCamera camera_;
  Odometer odometer_;
  Frame image_;
};

Eigen::Vector3d pose_error(const NavState& nav, const sim::RoverState& truth) {
  return {nav.x_m - truth.x_m, nav.y_m - truth.y_m, nav.yaw_rad - truth.yaw_rad};
}

double nees(const NavState& nav, const sim::RoverState& truth) {
  Eigen::Matrix3d cov;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      cov(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = nav.cov[i][j];
  }
  const Eigen::Vector3d error = pose_error(nav, truth);
  return error.dot(cov.ldlt().solve(error));
}

struct Outcome {
  double way_m = 0.0;  // of the axle
  double error_m = 0.0;
  double error_rad = 0.0;
  double largest_error_m = 0.0;
  double mean_nees = 0.0;
  double nees_at_end = 0.0;
  double velocity_chi2 = 0.0;  // of the sensors, per figure
  int refused = 0;
  FusionCounters counters{};
};

Outcome drive_on_frames(const sim::RoverPlan& plan, std::uint64_t seed) {
  const std::vector<sim::RoverState> states = sim::drive_rover(plan);
  const std::vector<sim::EncoderReading> encoders =
      sim::read_encoders(states, {.noise_rad_s = kEncoderNoise_rad_s}, seed);
  std::array<Lsv, 2> sensors{Lsv(kPlaces[0], 2 * seed), Lsv(kPlaces[1], 2 * seed + 1)};
  Navigator navigator = Navigator::create(rover(plan)).value();
  Outcome out;
  double chi2 = 0.0;
  int figures = 0, judged = 0;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const sim::RoverState& truth = states[k];
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const StepReport report = sensors[i].look(static_cast<std::int64_t>(k), truth);
      if (k == 0) continue;
      if (report.shift.status != ShiftStatus::ok) {
        ++out.refused;
        continue;
      }
      const SensorVelocity& v = report.velocity;
      navigator.add(i, LsvSample{report.stamp, static_cast<double>(report.dt_ns) * 1e-9, v.vx_m_s,
                                 v.vy_m_s, v.sigma_vx_m_s, v.sigma_vy_m_s});
      const sim::RoverState& before = states[k - 1];
      const double dx = v.vx_m_s - (before.vx_m_s - before.wz_rad_s * kPlaces[i].y_m);
      const double dy = v.vy_m_s - (before.vy_m_s + before.wz_rad_s * kPlaces[i].x_m);
      chi2 += std::pow(dx / v.sigma_vx_m_s, 2) + std::pow(dy / v.sigma_vy_m_s, 2);
      figures += 2;
    }
    navigator.add(WheelSample{{truth.time_ns}, encoders[k].left_rad_s, encoders[k].right_rad_s});
    if (k == 0) continue;
    out.way_m += std::hypot(truth.x_m - states[k - 1].x_m, truth.y_m - states[k - 1].y_m);
    const NavState nav = navigator.state();
    out.largest_error_m = std::max(out.largest_error_m, pose_error(nav, truth).head<2>().norm());
    if (k % 10 == 0) {
      out.mean_nees += nees(nav, truth);
      ++judged;
    }
  }
  const NavState nav = navigator.state();
  const Eigen::Vector3d error = pose_error(nav, states.back());
  out.error_m = error.head<2>().norm();
  out.error_rad = std::abs(error.z());
  out.mean_nees /= judged;
  out.nees_at_end = nees(nav, states.back());
  out.velocity_chi2 = chi2 / figures;
  out.counters = navigator.counters();
  std::printf(
      "%.1f s, %.4f m: off by %.1f um (%.4f %%), at most %.1f um, yaw %.1f urad; NEES %.2f "
      "at the end, %.2f on average (3); sensors chi2/n %.2f, %d refused, by fusion %d + %d; "
      "a frame: render %.2f ms, track %.2f ms\n",
      static_cast<double>(states.back().time_ns) * 1e-9, out.way_m, out.error_m * 1e6,
      100.0 * out.error_m / out.way_m, out.largest_error_m * 1e6, out.error_rad * 1e6,
      out.nees_at_end, out.mean_nees, out.velocity_chi2, out.refused,
      static_cast<int>(out.counters.lsv_refused_by_parity),
      static_cast<int>(out.counters.lsv_refused_by_innovation),
      500.0 * (sensors[0].render_s + sensors[1].render_s) / static_cast<double>(states.size()),
      500.0 * (sensors[0].track_s + sensors[1].track_s) / static_cast<double>(states.size()));
  return out;
}

TEST(DrivenFrames, EndWithinAThousandthOfTheWay) {
  const bool is_full = std::getenv("LSV_FULL_DRIVE") != nullptr;
  const Outcome out = drive_on_frames(is_full ? square_with_sand() : piece_with_sand(), 1);
  EXPECT_LE(out.error_m, 1e-3 * out.way_m);
  EXPECT_EQ(out.refused, 0);
  // Of one drive: chance exceeds 21 once in 1e4. The square starts and stops at once, see above.
  if (!is_full) {
    EXPECT_LT(out.nees_at_end, 21.0);
    EXPECT_LT(out.mean_nees, 21.0);
    EXPECT_LT(out.error_rad, 3e-4);
  }
}

}  // namespace
}  // namespace lsv
