// SPDX-License-Identifier: BSD-3-Clause
#include "bench/noise_drive.h"

#include <cmath>

#include "bench/accuracy_pair.h"
#include "lsv/odometer.h"
#include "tools/simulated_loop.h"

namespace lsv::bench {
namespace {

/// Across the motion the pattern creeps, so that no fraction of a px is special.
constexpr double kCreep_px = 0.137;

struct Sums {
  double step_x = 0.0, step_y = 0.0, travel = 0.0;
  int steps = 0, travels = 0, keyframes = 0;
};

void drive(const NoisePoint& point, std::uint64_t seed, int frames, DriveErrors& out, Sums& sums) {
  sim::SpeckleConfig config = camera_of(point);
  config.seed = seed;
  sim::SpeckleCamera camera = require_value(sim::SpeckleCamera::create(config));
  TrackConfig track;
  track.calibration = cli::matching_calibration(config);
  Odometer odometer = require_value(Odometer::create(track, sim::frame_format(config)));
  std::vector<double> error_x_px(1, 0.0), error_y_px(1, 0.0);
  std::int64_t keyframe = 0;
  Frame frame;
  for (int k = 0; k < frames; ++k) {
    const sim::PatternMotion motion{k * point.shift_px, k * kCreep_px, point.blur_px, 0.0};
    if (const Result<void> done = camera.render(k, motion, frame); !done)
      throw std::runtime_error(done.error().message);
    const StepReport report = require_value(odometer.push(frame.view()));
    if (k == 0) continue;
    if (report.shift.status != ShiftStatus::ok) ++out.refused;
    if (report.keyframe != keyframe) ++sums.keyframes;
    keyframe = report.keyframe;
    const double x_px = report.shift.dx_px - point.shift_px;
    const double y_px = report.shift.dy_px - kCreep_px;
    sums.step_x += x_px * x_px;
    sums.step_y += y_px * y_px;
    ++sums.steps;
    error_x_px.push_back(error_x_px.back() + x_px);
    error_y_px.push_back(error_y_px.back() + y_px);
  }
  for (std::size_t end = kTravelFrames; end < error_x_px.size(); end += kTravelFrames) {
    const double x_px = error_x_px[end] - error_x_px[end - kTravelFrames];
    const double y_px = error_y_px[end] - error_y_px[end - kTravelFrames];
    sums.travel += 0.5 * (x_px * x_px + y_px * y_px);
    ++sums.travels;
  }
}

}  // namespace

const std::vector<NoisePoint>& noise_drives() {
  // side, speckle, blur, mean, noise, bits, full well, rho, shift
  static const std::vector<NoisePoint> points = {
      {128, 4.0, 0.0, 60.0, 0.5, 8, 0.0, 1.0, 1.3},
      {128, 4.0, 2.3, 60.0, 0.5, 8, 10000.0, 1.0, 11.4},
      {96, 3.4, 0.0, 30.0, 2.0, 8, 0.0, 1.0, 4.3},
      {128, 3.2, 0.0, 50.0, 0.5, 8, 0.0, 0.99, 3.1},
      {128, 3.6, 1.5, 50.0, 2.0, 8, 0.0, 0.9995, 5.2},
  };
  return points;
}

DriveErrors simulate_drive(const NoisePoint& point, int drives, int frames) {
  DriveErrors out;
  Sums sums;
  for (int i = 0; i < drives; ++i)
    drive(point, 9000 + static_cast<std::uint64_t>(i), frames, out, sums);
  out.step_x_px = std::sqrt(sums.step_x / sums.steps);
  out.step_y_px = std::sqrt(sums.step_y / sums.steps);
  out.travel_px = std::sqrt(sums.travel / sums.travels);
  out.frames_per_keyframe = static_cast<double>(sums.steps) / std::max(1, sums.keyframes);
  return out;
}

}  // namespace lsv::bench
