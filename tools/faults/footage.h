// SPDX-License-Identifier: BSD-3-Clause
// Frames of a camera over moving ground with their truth, rendered once and shown to every
// scenario that wants them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "sim/speckle.h"

namespace lsv::faults {

inline constexpr std::int64_t kPeriod_ns = 1'000'000;

struct Position {
  double x_px = 0.0;
  double y_px = 0.0;
};

class Footage {
 public:
  static Result<std::shared_ptr<const Footage>> render(const sim::SpeckleConfig& camera,
                                                       const sim::MotionProfile& motion,
                                                       std::int64_t exposures);

  std::int64_t exposures() const { return static_cast<std::int64_t>(frames_.size()); }
  FrameView frame(std::int64_t exposure) const { return frames_[index(exposure)].view(); }
  const Position& position(std::int64_t exposure) const { return positions_[index(exposure)]; }
  const sim::SpeckleConfig& camera() const { return camera_; }
  FrameFormat format() const { return sim::frame_format(camera_); }
  /// The defaults, with a calibration that fits the camera.
  TrackConfig config() const;

 private:
  static std::size_t index(std::int64_t exposure) { return static_cast<std::size_t>(exposure); }

  sim::SpeckleConfig camera_;
  std::vector<Frame> frames_;
  std::vector<Position> positions_;
};

/// What the scenarios are shot on.
enum class Scene {
  drive,      // up to 3 px a frame, with a stop and a turn
  too_fast,   // speeds up to 1.5 times the side of the frame
  blurred,    // up to 10 px a frame, exposed all the time
  boiling_0,  // the drive over ground that changes: correlation 0.99 from frame to frame
  boiling_1,  // 0.9
  boiling_2,  // 0.7
  boiling_3,  // 0.5
  boiling_4,  // 0.2
  boiling_5,  // 0: no two frames have anything in common
};

/// Renders a scene when it is first asked for.
class Scenes {
 public:
  /// `side_px` >= 32, `exposures` >= 100.
  Scenes(int side_px, std::int64_t exposures) : side_px_(side_px), exposures_(exposures) {}
  Result<std::shared_ptr<const Footage>> get(Scene scene);

 private:
  int side_px_;
  std::int64_t exposures_;
  std::vector<std::pair<Scene, std::shared_ptr<const Footage>>> rendered_;
};

}  // namespace lsv::faults
