// SPDX-License-Identifier: BSD-3-Clause
// Every setting of a stream with its unit, range and default.
#pragma once

#include <cstdint>

#include "lsv/core/result.h"
#include "lsv/core/stamp.h"

namespace lsv {

struct StreamOptions {
  /// Frames that may wait to be measured, [1, 65536]. When they are that many the oldest is
  /// dropped, so no frame waits longer than this many periods.
  int queue_frames = 64;
  /// Reports kept for Stream::next(), [0, 1e6]; 0: nobody fetches them.
  int queue_reports = 0;
  /// Silence after which the source counts as lost, > 0. Never less than three periods.
  std::int64_t lost_after_ns = 90'000'000;
  std::int64_t health_every_ns = kNsPerS;  // > 0
  /// SCHED_FIFO priority of the threads, [1, 98]; 0: as the system has it.
  int fifo_priority = 0;
  bool lock_memory = false;
};

/// The first setting that is out of its range, named with its value.
Result<void> validate(const StreamOptions& options);

}  // namespace lsv
