// SPDX-License-Identifier: BSD-3-Clause
// The streaming measurement pipeline: push frames, get shift, velocity and position.
//
//   frame -> shift of the pattern and its position (keyframe_odometry.h; the preset `classic`:
//   frame_to_frame.h) -> velocity and position on the ground (calibration)
//
// create() makes plans and memory for one frame format; push() allocates nothing, never prints
// and never blocks on I/O. One odometer serves one sensor and one thread at a time. Equal frames
// give equal results to the bit.
#pragma once

#include <optional>
#include <variant>

#include "calibration/scale.h"
#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/core/step_report.h"
#include "lsv/frame_to_frame.h"
#include "lsv/keyframe_odometry.h"

namespace lsv {

class Odometer {
 public:
  /// invalid_argument when a setting is out of range or does not fit the frames, or memory is
  /// short.
  static Result<Odometer> create(const TrackConfig& config, const FrameFormat& format);

  /// Frames in order of time. bad_input when the format differs from the one announced, a 16-bit
  /// pixel exceeds its bit depth or lies at an odd address, or the stamp does not increase; the
  /// frame is then ignored and the odometer stays usable. `frame` is not kept.
  Result<StepReport> push(const FrameView& frame);

  /// Searched where nothing is known: see CorrelationConfig::max_shift_px.
  const LagRange& lags() const;
  /// The correlation over all lags between the frame pushed last and the accepted one before it.
  /// Where the shift was found without it, it is made now. Overwritten by the next push; means
  /// nothing when that frame was unfit to be correlated.
  const CorrelationPlane& plane();

 private:
  using Follower = std::variant<KeyframeOdometry, FrameToFrame>;

  Odometer(const TrackConfig& config, const FrameFormat& format, Follower follower);
  static Result<Follower> make_follower(const TrackConfig& config, const FrameFormat& format);
  Result<void> check(const FrameView& frame) const;

  FrameFormat format_;
  PixelScale scale_;
  Follower follower_;
  std::optional<Stamp> last_stamp_;  // of the frame pushed last
  Stamp first_stamp_{};
};

}  // namespace lsv
