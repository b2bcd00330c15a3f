// SPDX-License-Identifier: BSD-3-Clause
// The search over the full range of lags: FFT correlation, sub-pixel peak, quality, gate. For two
// frames of which nothing is known, and to find the pattern again where tracking has lost it.
// Owns plans and memory, allocates at creation only; one object per thread.
#pragma once

#include <memory>

#include "correlation/correlator.h"
#include "correlation/quality.h"
#include "correlation/track_frame.h"
#include "lsv/core/config.h"
#include "lsv/core/result.h"
#include "lsv/core/shift.h"

namespace lsv {

class Acquisition {
 public:
  static Result<Acquisition> create(const TrackConfig& config, const FrameFormat& format);

  /// The shift from one frame to the other, with the status that the gate gives it.
  Shift measure(const TrackFrame& earlier, const TrackFrame& later);

  const LagRange& lags() const { return correlator_->lags(); }
  /// Of the pair measured last.
  const CorrelationPlane& plane() const { return plane_; }

 private:
  Acquisition(const TrackConfig& config, std::unique_ptr<Correlator> correlator);

  PeakFit fit_;
  ErrorModel model_;
  GateConfig gate_;
  std::unique_ptr<Correlator> correlator_;
  CorrelationPlane plane_;
  PreparedFrame earlier_;
  PreparedFrame later_;
};

}  // namespace lsv
