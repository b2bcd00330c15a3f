// SPDX-License-Identifier: BSD-3-Clause
// The measurements of `lsv budget`: what each stage of the pipeline takes on this machine, and
// whether results keep up with frames that arrive at a fixed rate. Runs on the calling thread.
#pragma once

#include <cstddef>

#include "lsv/core/config.h"
#include "lsv/core/result.h"
#include "tools/duration_samples.h"
#include "tools/simulated_loop.h"

namespace lsv::cli {

/// As fast as the machine goes: whole pushes of a steady drive and, for the frames that need it,
/// the stages of a full search.
struct UnpacedTimes {
  DurationSummary push;
  DurationSummary prepare;
  DurationSummary correlate;
  DurationSummary peak_and_quality;
  std::size_t shifts_refused = 0;
  double largest_error_px = 0.0;  // of the accepted shifts, against the simulated truth, per axis

  double max_rate_hz() const { return 1e6 / push.mean_us; }
};

/// One frame due every period. A frame that is late is still measured, at once, so that a backlog
/// is worked off or grows.
struct PacedTimes {
  double period_us = 0.0;
  std::size_t frames_due = 0;
  DurationSummary wake_up;  // from the due time until the program runs; frames it waited for
  DurationSummary push;
  DurationSummary latency;  // from the due time of a frame to its result
  std::size_t late = 0;     // results that were not there when the next frame was due, or never

  double headroom() const { return period_us / latency.p999_us; }
  /// 99.9 % of the results were there before the next frame was due.
  bool holds() const { return late * 1000 <= frames_due; }
};

/// Up to `frames` frames; stops earlier, after a few, rather than take much longer than `limit_s`.
/// Both end early when the user interrupts (tools/interrupt.h).
Result<UnpacedTimes> measure_unpaced(const TrackConfig& config, const SimulatedLoop& loop,
                                     std::size_t frames, double limit_s);

/// `frames` >= 1 frames at `rate_hz`; gives up one second after the last of them was due.
Result<PacedTimes> measure_paced(const TrackConfig& config, const SimulatedLoop& loop,
                                 std::size_t frames, double rate_hz);

}  // namespace lsv::cli
