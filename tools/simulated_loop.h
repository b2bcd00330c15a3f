// SPDX-License-Identifier: BSD-3-Clause
// Simulated frames rendered once and played for ever, there and back (0 1 2 3 2 1 0 1 ...), so that
// every two consecutive frames are a valid pair with a known shift. For timing the pipeline.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "sim/speckle.h"

namespace lsv::cli {

/// Which of `frames` >= 2 frames is number `k` >= 0 of that endless recording.
std::size_t there_and_back(std::int64_t k, std::size_t frames);

struct TrueShift {
  double dx_px = 0.0;
  double dy_px = 0.0;
};

class SimulatedLoop {
 public:
  /// `frames` >= 2 frames of `camera`; the pattern swings to and fro along the diagonal, with up to
  /// `max_step_px` per frame along each axis.
  static Result<SimulatedLoop> render(const sim::SpeckleConfig& camera, double max_step_px,
                                      int frames);
  /// The same with frames along `motion`; played there and back, its speed turns at the ends.
  static Result<SimulatedLoop> render(const sim::SpeckleConfig& camera,
                                      const sim::MotionProfile& motion, int frames);

  int frame_count() const { return static_cast<int>(frames_.size()); }
  const FrameFormat& format() const { return frames_.front().format; }
  /// Frame `k` >= 0 of the endless recording, with its stamp. Lives as long as the loop.
  FrameView frame(std::int64_t k) const;
  /// Of the pattern in frame k.
  TrueShift position(std::int64_t k) const {
    return positions_[there_and_back(k, positions_.size())];
  }
  /// From frame k - 1 to frame k; k >= 1.
  TrueShift shift(std::int64_t k) const;

 private:
  SimulatedLoop() = default;

  double frame_rate_hz_ = 0.0;
  std::vector<Frame> pixels_;
  std::vector<FrameView> frames_;
  std::vector<TrueShift> positions_;
};

/// A calibration that fits the noise of `camera`; its geometry is that of the Masuku thesis.
Calibration matching_calibration(const sim::SpeckleConfig& camera);
/// Defaults for a loop of frames of `camera`: they come back bit for bit, and are not frozen.
TrackConfig loop_config(const sim::SpeckleConfig& camera);

}  // namespace lsv::cli
