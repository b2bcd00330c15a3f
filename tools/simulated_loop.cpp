// SPDX-License-Identifier: BSD-3-Clause
#include "tools/simulated_loop.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace lsv::cli {

std::size_t there_and_back(std::int64_t k, std::size_t frames) {
  const std::size_t period = 2 * (frames - 1);
  const std::size_t phase = static_cast<std::size_t>(k) % period;
  return phase < frames ? phase : period - phase;
}

Result<SimulatedLoop> SimulatedLoop::render(const sim::SpeckleConfig& camera, double max_step_px,
                                            int frames) {
  // Half a swing of a pendulum: the other half is the way back.
  const double phase_per_frame = std::numbers::pi / (frames - 1);
  const double amplitude_px = max_step_px / phase_per_frame;
  const auto swing = [=](std::int64_t k) {
    const double phase = phase_per_frame * static_cast<double>(k);
    const double at_px = amplitude_px * (1.0 - std::cos(phase));
    const double v_px = max_step_px * std::sin(phase);
    return sim::PatternMotion{at_px, at_px, v_px, v_px};
  };
  return render(camera, swing, frames);
}

Result<SimulatedLoop> SimulatedLoop::render(const sim::SpeckleConfig& camera,
                                            const sim::MotionProfile& motion, int frames) {
  Result<sim::SpeckleCamera> source = sim::SpeckleCamera::create(camera);
  if (!source) return source.error();
  SimulatedLoop loop;
  loop.frame_rate_hz_ = camera.frame_rate_hz;
  for (int k = 0; k < frames; ++k) {
    const sim::PatternMotion at = motion(k);
    Frame frame;
    if (Result<void> rendered = source.value().render(k, at, frame); !rendered)
      return rendered.error();
    loop.positions_.push_back({at.x_px, at.y_px});
    loop.frames_.push_back(frame.view());
    loop.pixels_.push_back(std::move(frame));
  }
  return loop;
}

FrameView SimulatedLoop::frame(std::int64_t k) const {
  FrameView out = frames_[there_and_back(k, frames_.size())];
  out.index = k;
  out.stamp.ns =
      std::llround(static_cast<double>(k) * static_cast<double>(kNsPerS) / frame_rate_hz_);
  return out;
}

TrueShift SimulatedLoop::shift(std::int64_t k) const {
  const TrueShift from = position(k - 1);
  const TrueShift to = position(k);
  return {to.dx_px - from.dx_px, to.dy_px - from.dy_px};
}

Calibration matching_calibration(const sim::SpeckleConfig& camera) {
  Calibration out;
  out.sensor_name = "simulated";
  out.pixel_pitch_x_m = 14e-6;
  out.pixel_pitch_y_m = 14e-6;
  out.sc_x_ratio = 1.985;
  out.sc_y_ratio = 2.0;
  out.noise_mean_counts = camera.noise_mean_counts;
  out.noise_sd_counts = camera.noise_sd_counts;
  return out;
}

TrackConfig loop_config(const sim::SpeckleConfig& camera) {
  TrackConfig out;
  out.calibration = matching_calibration(camera);
  out.gate.refuse_frozen = false;
  return out;
}

}  // namespace lsv::cli
