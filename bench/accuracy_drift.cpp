// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "bench/accuracy_methods.h"
#include "bench/accuracy_pair.h"
#include "bench/accuracy_run.h"
#include "bench/frames.h"
#include "calibration/scale.h"
#include "lsv/odometer.h"
#include "sim/motion_profile.h"

namespace lsv::bench {
namespace {

constexpr double kParkedSpeckle_px = 4.0;

sim::SpeckleConfig camera_of(double speckle_px) {
  sim::SpeckleConfig out = condition_named("B").camera;
  out.speckle_px = speckle_px;
  return out;
}

/// An odometer and what it has said so far.
class Follower {
 public:
  Follower(const TrackConfig& config, const sim::SpeckleConfig& camera)
      : odometer_(require_value(Odometer::create(config, sim::frame_format(camera)))),
        scale_(pixel_scale(config.calibration)) {}

  void push(const Frame& frame) {
    const bool is_first = frames_++ == 0;
    report_ = require_value(odometer_.push(frame.view()));
    if (!is_first && report_.shift.status != ShiftStatus::ok) ++refused_;
  }

  const StepReport& report() const { return report_; }
  int refused() const { return refused_; }
  double x_px() const { return report_.position.x_m / scale_.xx; }
  double y_px() const { return report_.position.y_m / scale_.yy; }

 private:
  Odometer odometer_;
  PixelScale scale_;
  StepReport report_;
  int frames_ = 0;
  int refused_ = 0;
};

/// Renders `frames` + 1 frames, the first of them the start, and calls `see(frame)` for each.
template <typename See>
void film(const sim::SpeckleConfig& config, const sim::MotionProfile& motion, int frames, See see) {
  sim::SpeckleCamera camera = require_value(sim::SpeckleCamera::create(config));
  Frame frame;
  for (int k = 0; k <= frames; ++k) {
    if (const Result<void> done = camera.render(k, motion(k), frame); !done)
      throw std::runtime_error(done.error().message);
    see(frame);
  }
}

TrackConfig classic_config(const sim::SpeckleConfig& camera) {
  TrackConfig out = track_config(Preset::classic, camera);
  out.correlation.peak_fit = PeakFit::gaussian3;
  return out;
}

DriftResult measure_drift(const Drive& drive, int frames) {
  const sim::SpeckleConfig camera = camera_of(drive.speckle_px);
  Follower precise(track_config(Preset::precise, camera), camera);
  Follower classic(classic_config(camera), camera);
  film(camera, sim::constant_velocity(drive.speed_px_per_frame, 0.0), frames,
       [&](const Frame& frame) {
         precise.push(frame);
         classic.push(frame);
       });
  const double distance_px = drive.speed_px_per_frame * frames;
  return {.speckle_px = drive.speckle_px,
          .speed_px_per_frame = drive.speed_px_per_frame,
          .frames = frames,
          .precise_error_ratio = precise.x_px() / distance_px - 1.0,
          .classic_error_ratio = classic.x_px() / distance_px - 1.0,
          .precise_refused = precise.refused(),
          .classic_refused = classic.refused()};
}

}  // namespace

std::vector<DriftResult> measure_drifts(const std::vector<Drive>& drives, int frames) {
  std::vector<DriftResult> out;
  for (const Drive& drive : drives) {
    std::fprintf(stderr, "accuracy: drift, speckle of %g px, %g px per frame, %d frames\n",
                 drive.speckle_px, drive.speed_px_per_frame, frames);
    out.push_back(measure_drift(drive, frames));
  }
  return out;
}

ParkedResult measure_parked(int frames) {
  std::fprintf(stderr, "accuracy: parked, %d frames\n", frames);
  const sim::SpeckleConfig camera = camera_of(kParkedSpeckle_px);
  Follower precise(track_config(Preset::precise, camera), camera);
  ParkedResult out{.frames = frames};
  film(camera, sim::parked(), frames, [&](const Frame& frame) {
    precise.push(frame);
    out.farthest_px = std::max(out.farthest_px, std::hypot(precise.x_px(), precise.y_px()));
    if (precise.report().motion == MotionState::moving) ++out.frames_moving;
  });
  out.refused = precise.refused();
  return out;
}

}  // namespace lsv::bench
