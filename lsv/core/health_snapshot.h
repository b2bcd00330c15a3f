// SPDX-License-Identifier: BSD-3-Clause
// What a running stream says about itself, copied at one instant: plain numbers, no pointers, so
// that telemetry, dashboards and recordings need nothing else. Counters never fall while a stream
// lives. Unknown durations are NaN.
//
// Bookkeeping that always holds (invariant I1 of the fault campaign):
//   received = processed + rejected (all reasons) + dropped + queued
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "lsv/core/shift.h"

namespace lsv {

enum class StreamState {
  starting,  // no frame yet
  running,   // frames arrive
  lost,      // none for longer than StreamOptions::lost_after_ns; being re-opened where it can be
  degraded,  // the restart budget is spent: optics off until someone acts
  ended,     // stopped, or the source came to its end
};

/// Why a frame that arrived was not given to the odometer.
enum class FrameRejection {
  none,
  damaged,       // the transport says so: packets missing, wrong size
  wrong_format,  // size, pixel type or bit depth is not that of the stream
  duplicate,     // the id of a frame seen before
  late,          // older than a frame already processed
  refused,       // by the odometer: pixels above full scale, stamp out of range
};

inline constexpr std::array kAllFrameRejections = {
    FrameRejection::damaged, FrameRejection::wrong_format, FrameRejection::duplicate,
    FrameRejection::late, FrameRejection::refused};

/// The words of every output (`running`, `wrong_format`, ...).
std::string_view word(StreamState state);
std::string_view word(FrameRejection rejection);

/// Quantiles over the life of the stream, within 2 %.
struct LatencySummary {
  std::int64_t count = 0;
  double p50_s = kUnknown;
  double p99_s = kUnknown;
  double p999_s = kUnknown;
  double max_s = kUnknown;
};

struct HealthSnapshot {
  StreamState state = StreamState::starting;

  std::int64_t received = 0;   // frames that the source handed over
  std::int64_t processed = 0;  // given to the odometer and answered
  std::int64_t dropped = 0;    // by the image queue: the worker was too slow
  std::int64_t queued = 0;     // waiting or being measured now
  std::array<std::int64_t, kAllFrameRejections.size()> rejected{};  // in that order
  std::int64_t missing = 0;  // exposures that had not arrived when a later one did, by the stamps
  std::int64_t gaps = 0;     // runs of missing exposures
  std::int64_t bad_stamps = 0;  // stamps replaced by id x period

  std::int64_t shifts_ok = 0;
  std::int64_t shifts_refused = 0;
  double since_valid_shift_s = kUnknown;  // age of the last accepted shift

  std::int64_t deadline_misses = 0;   // results later than one period after arrival
  std::int64_t reports_dropped = 0;   // by the queue of next(): nobody took them in time
  std::int64_t log_dropped = 0;       // frames that no recording got: disk full or too slow
  std::int64_t restarts = 0;          // times that the source was re-opened
  std::int64_t transport_losses = 0;  // packets or frames that the camera's driver counted as lost

  double frame_rate_hz = kUnknown;    // over the last second or two, or since the start
  LatencySummary latency{};           // arrival of a frame to its result
  double queue_age_max_s = kUnknown;  // longest wait of a frame before it was measured
  double since_result_s = kUnknown;   // age of the last result
  std::int64_t worker_stalls = 0;     // times that frames waited half a second without a result
};

}  // namespace lsv
