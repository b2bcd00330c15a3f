// SPDX-License-Identifier: BSD-3-Clause
// The classic way: every frame against the frame before by a full search, shifts summed up.
// Lost pairs are lost: nothing bridges them. What is prepared of a frame serves two pairs.
#pragma once

#include <memory>

#include "correlation/correlator.h"
#include "correlation/quality.h"
#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/fixed_pattern.h"
#include "lsv/path.h"
#include "lsv/pattern_step.h"

namespace lsv {

/// Owns plans and memory, allocates at creation only; one object per thread.
class FrameToFrame {
 public:
  static Result<FrameToFrame> create(const TrackConfig& config, const FrameFormat& format,
                                     FixedPattern fixed_pattern);

  /// `frame` must have the format given at creation and a later stamp than the one before.
  PatternStep step(const FrameView& frame);

  const LagRange& lags() const { return correlator_->lags(); }
  /// Of the pair correlated last.
  const CorrelationPlane& plane() const { return plane_; }

 private:
  struct Slot {
    PreparedFrame frame;
    ShiftStatus fitness = ShiftStatus::first_frame;
    Stamp stamp{};
    std::int64_t index = -1;
  };

  FrameToFrame(const TrackConfig& config, std::unique_ptr<Correlator> correlator,
               FixedPattern fixed_pattern);
  Shift measure();

  TrackConfig config_;
  FixedPattern fixed_pattern_;
  std::unique_ptr<Correlator> correlator_;
  CorrelationPlane plane_;
  Slot earlier_;
  Slot later_;
  Path path_;
};

}  // namespace lsv
