// SPDX-License-Identifier: BSD-3-Clause
// A camera in the same process: pictures made before, delivered at a fixed rate by absolute
// deadlines, so that it never drifts. Like a camera it does not wait: what is not fetched stays in
// a few driver buffers, and what finds none free is lost, with ids that tell.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "lsv/stream/host_clock.h"
#include "lsv/stream/live_source.h"
#include "lsv/stream/sync.h"

namespace lsv {

struct PacedOptions {
  std::int64_t period_ns = 1'000'000;                              // > 0
  std::int64_t frames = std::numeric_limits<std::int64_t>::max();  // then it has ended
  std::int64_t driver_buffers = 64;                                // >= 1
};

class PacedSource : public LiveSource {
 public:
  /// Pixels of exposure k = 0, 1, 2, ...; of one format; valid until the next call. Called by
  /// grab() only.
  using Pictures = std::function<FrameView(std::int64_t exposure)>;

  /// The first exposure is one period after the first grab().
  PacedSource(Pictures pictures, const PacedOptions& options);

  const LiveSourceInfo& info() const override { return info_; }
  /// The stamp is the deadline, and so is the time of arrival: what the host takes longer is
  /// latency. Index of the frame: its exposure.
  Result<Grab> grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) override;
  void stop() override;
  std::int64_t transport_losses() const override { return lost_; }

 private:
  bool wait_until(std::int64_t until_ns);

  Pictures pictures_;
  PacedOptions options_;
  LiveSourceInfo info_;
  std::int64_t begin_ns_ = 0;  // deadline of exposure 0
  std::int64_t next_ = 0;
  std::int64_t lost_ = 0;
  PriorityMutex mutex_;
  Signal stopped_signal_;
  bool stopped_ = false;
};

}  // namespace lsv
