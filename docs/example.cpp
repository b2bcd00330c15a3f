#include <cstdio>
#include <vector>

#include "calibration/calibration_io.h"
#include "lsv/odometer.h"

// Stands for your camera driver: fills `pixels` and says when the frame was exposed.
bool next_frame(std::vector<std::byte>& pixels, lsv::Stamp& stamp);

int main() {
  const auto calibration = lsv::load_calibration("sample_frames/calibration.toml");
  if (!calibration) return std::puts(calibration.error().message.c_str()), 1;

  lsv::TrackConfig config;
  config.calibration = calibration.value();
  const lsv::FrameFormat format{.width_px = 128, .height_px = 128};
  auto odometer = lsv::Odometer::create(config, format);
  if (!odometer) return std::puts(odometer.error().message.c_str()), 1;

  std::vector<std::byte> pixels(128 * 128);
  lsv::FrameView frame{.data = pixels.data(), .stride_bytes = 128, .format = format};
  while (next_frame(pixels, frame.stamp)) {
    const auto report = odometer.value().push(frame);  // allocates nothing, prints nothing
    if (!report) return std::puts(report.error().message.c_str()), 1;
    const lsv::StepReport& step = report.value();
    if (step.shift.status == lsv::ShiftStatus::ok)
      std::printf("%.4f +- %.4f m/s\n", step.velocity.vx_m_s, step.velocity.sigma_vx_m_s);
    else
      std::printf("no velocity: %s\n", lsv::word(step.shift.status).data());
    ++frame.index;
  }
}
