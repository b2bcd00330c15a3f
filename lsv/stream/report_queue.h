// SPDX-License-Identifier: BSD-3-Clause
// Reports for whoever fetches them: a bounded queue between the worker of a stream and one reader.
// Full: the oldest report goes and is counted; the reader sees the hole in StepReport::frame.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lsv/stream/stream_sink.h"
#include "lsv/stream/sync.h"

namespace lsv {

class ReportQueue : public StreamSink {
 public:
  /// `reports` >= 1 are kept.
  explicit ReportQueue(std::size_t reports) : slots_(reports) {}

  void on_report(const StreamReport& report, Frame& frame) override;
  void on_event(const StreamEvent&) override {}
  void on_health(const HealthSnapshot&) override {}

  /// The oldest report, waiting for one at most `timeout_ns`. Empty: none came, or after close()
  /// there will be none.
  std::optional<StreamReport> next(std::int64_t timeout_ns);
  /// No more reports will come.
  void close();
  bool is_empty();
  std::int64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  PriorityMutex mutex_;
  Signal signal_;
  std::vector<StreamReport> slots_;
  std::size_t head_ = 0;
  std::size_t size_ = 0;
  bool closed_ = false;
  std::atomic<std::int64_t> dropped_{0};
};

}  // namespace lsv
