// SPDX-License-Identifier: BSD-3-Clause
// The streaming measurement pipeline: push frames, get shift, velocity and position.
//
//   frame -> correlate with the frame before -> sub-pixel peak -> quality -> gate
//         -> velocity (calibration) -> integrated position
//
// create() makes plans and memory for one frame format; push() allocates nothing, never prints
// and never blocks on I/O. One odometer serves one sensor and one thread at a time. Equal frames
// give equal results to the bit.
#pragma once

#include <memory>

#include "calibration/scale.h"
#include "correlation/correlator.h"
#include "correlation/quality.h"
#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/core/step_report.h"
#include "lsv/integrate.h"

namespace lsv {

class Odometer {
 public:
  /// invalid_argument when a setting is out of range or does not fit the frames, or memory is
  /// short.
  static Result<Odometer> create(const TrackConfig& config, const FrameFormat& format);

  /// Frames in order of time. bad_input when the format differs from the one announced or the
  /// stamp does not increase; the frame is then ignored and the odometer stays usable. `frame`
  /// is not kept.
  Result<StepReport> push(const FrameView& frame);

  const LagRange& lags() const { return correlator_->lags(); }
  /// The plane of the latest pair that was correlated; overwritten by the next push.
  const CorrelationPlane& plane() const { return plane_; }

 private:
  struct Slot {
    PreparedFrame frame;
    ShiftStatus fitness = ShiftStatus::first_frame;
    Stamp stamp{};
  };

  Odometer(const TrackConfig& config, std::unique_ptr<Correlator> correlator);

  Result<void> check(const FrameView& frame) const;
  Shift measure();

  TrackConfig config_;
  PixelScale scale_;
  std::unique_ptr<Correlator> correlator_;
  CorrelationPlane plane_;
  Slot earlier_;
  Slot later_;
  Stamp last_stamp_{};  // of the frame pushed last, frozen ones included
  Integrator integrator_;
};

}  // namespace lsv
