#include <cstdio>
#include <memory>
#include <utility>

#include "calibration/calibration_io.h"
#include "lsv/stream/reopening_source.h"
#include "lsv/stream/stream.h"

// Stands for your camera: an implementation of lsv::LiveSource (lsv/stream/live_source.h).
lsv::Result<std::unique_ptr<lsv::LiveSource>> open_camera();

int main() {
  const auto calibration = lsv::load_calibration("sample_frames/calibration.toml");
  if (!calibration) return std::puts(calibration.error().message.c_str()), 1;
  lsv::TrackConfig config;
  config.calibration = calibration.value();

  // Opened anew whenever the cable was pulled.
  auto camera = lsv::ReopeningSource::open(open_camera);
  if (!camera) return std::puts(camera.error().message.c_str()), 1;
  auto started = lsv::Stream::start(std::move(camera).value(), config, {.queue_reports = 64});
  if (!started) return std::puts(started.error().message.c_str()), 1;
  lsv::Stream& stream = *started.value();

  double vx_m_s = 0.0;
  while (const auto report = stream.next()) {  // waits; empty when the camera has ended
    if (report->step.shift.status == lsv::ShiftStatus::ok) vx_m_s = report->step.velocity.vx_m_s;
    if (report->missing_before + report->dropped_before > 0)
      std::printf("a gap before frame %lld\n", static_cast<long long>(report->step.frame));
  }
  const lsv::HealthSnapshot health = stream.health();
  std::printf("%lld frames, %lld missing, %lld dropped; last speed %.4f m/s\n",
              static_cast<long long>(health.received), static_cast<long long>(health.missing),
              static_cast<long long>(health.dropped), vx_m_s);
}
