#include <cstdio>
#include <memory>
#include <utility>

#include "calibration/calibration_io.h"
#include "fusion/navigator.h"
#include "lsv/stream/stream.h"

// Stands for your camera: an implementation of lsv::LiveSource (lsv/stream/live_source.h).
lsv::Result<std::unique_ptr<lsv::LiveSource>> open_camera();
// Stands for your motor driver: rates of the wheels at that time, on the clock of the camera.
lsv::WheelSample read_wheels(lsv::Stamp now) { return {now, 0.0, 0.0}; }

int main() {
  const auto calibration = lsv::load_calibration("sample_frames/calibration.toml");
  if (!calibration) return std::puts(calibration.error().message.c_str()), 1;
  lsv::TrackConfig config;
  config.calibration = calibration.value();
  auto camera = open_camera();
  if (!camera) return std::puts(camera.error().message.c_str()), 1;
  auto stream = lsv::Stream::start(std::move(camera).value(), config, {.queue_reports = 64});
  if (!stream) return std::puts(stream.error().message.c_str()), 1;

  lsv::FusionConfig rover;
  rover.wheels = {.radius_m = 0.1, .track_m = 0.8, .noise_rad_s = 0.017};
  rover.lsv = {{.name = "front", .x_m = 0.2, .y_m = 0.0, .noise_m_s = 7e-4}};
  auto navigator = lsv::Navigator::create(rover);
  if (!navigator) return std::puts(navigator.error().message.c_str()), 1;

  while (const auto report = stream.value()->next()) {
    const lsv::StepReport& step = report->step;
    if (step.shift.status == lsv::ShiftStatus::ok) {
      navigator.value().add(0, {.stamp = step.stamp,
                                .interval_s = 1e-9 * static_cast<double>(step.dt_ns),
                                .vx_m_s = step.velocity.vx_m_s,
                                .vy_m_s = step.velocity.vy_m_s,
                                .sigma_vx_m_s = step.velocity.sigma_vx_m_s,
                                .sigma_vy_m_s = step.velocity.sigma_vy_m_s});
    }
    navigator.value().add(read_wheels(step.stamp));
    if (navigator.value().state_at(step.stamp).left.is_slipping) std::puts("the left wheel slips");
  }
  const lsv::NavState end = navigator.value().state();
  std::printf("pose %.6f m, %.6f m, %.6f rad\n", end.x_m, end.y_m, end.yaw_rad);
}
