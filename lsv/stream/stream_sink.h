// SPDX-License-Identifier: BSD-3-Clause
// What a stream hands out, and who may listen: the caller's callback, a recording, a dashboard.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "lsv/core/frame.h"
#include "lsv/core/health_snapshot.h"
#include "lsv/core/step_report.h"
#include "lsv/stream/live_source.h"

namespace lsv {

/// A frame that was processed, with all that was decided about it on the way.
struct StreamReport {
  StepReport step{};
  FrameLabel label{};
  std::int64_t missing_before = 0;  // exposures since the frame processed before that never arrived
  std::int64_t dropped_before = 0;  // frames since then that the image queue dropped
  std::int64_t rejected_before = 0;  // frames since then that were not given to the odometer
  bool stamp_replaced = false;       // the camera's stamp was nonsense: id x period instead
  std::int64_t latency_ns = 0;       // arrival to result, monotonic
};

enum class Severity { info, warning, error };

/// Something worth a line in a log: source lost or re-opened, frames missing, a recording that
/// misses frames. Rare, so it may hold text.
struct StreamEvent {
  std::int64_t host_ns = 0;  // monotonic
  Severity severity = Severity::info;
  std::string name;  // one word that programs can match: "source_lost", "frames_missing", ...
  std::string text;  // one sentence for a person
};

/// Called on the worker thread of one stream, in order, so it must neither block on I/O nor
/// allocate in on_report(): hand over and return. What it cannot take in time it drops and counts.
class StreamSink {
 public:
  virtual ~StreamSink() = default;

  /// `frame` is the one that `report` speaks of. The sink may swap it for another Frame of the
  /// same format, whose memory is then the stream's.
  virtual void on_report(const StreamReport& report, Frame& frame) = 0;
  virtual void on_event(const StreamEvent& event) = 0;
  /// About once a second.
  virtual void on_health(const HealthSnapshot& health) = 0;

  /// Frames that this sink could not keep, for HealthSnapshot::log_dropped. Thread-safe.
  virtual std::int64_t frames_dropped() const { return 0; }
};

}  // namespace lsv
