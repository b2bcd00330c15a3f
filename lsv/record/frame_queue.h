// SPDX-License-Identifier: BSD-3-Clause
// From the thread of a stream to that of its recorder: a ring of frames allocated at the start.
// push() belongs to one thread, the rest to another.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/mcap/messages.h"
#include "lsv/stream/stream_sink.h"

namespace lsv {

struct FrameToRecord {
  StreamReport report{};
  Frame frame{};
  std::uint64_t ordinal = 0;    // of all reports, those that found the queue full included
  mcap::Dropout lost_before{};  // these, since the frame before; frames = 0 without any
};

class FrameQueue {
 public:
  FrameQueue(std::size_t frames, const FrameFormat& format) : slots_(frames) {
    for (FrameToRecord& slot : slots_) slot.frame.reset(format);
  }

  /// Swaps `frame` into the ring, or returns false when it is full. Allocates nothing.
  bool push(const StreamReport& report, Frame& frame, std::uint64_t ordinal,
            const mcap::Dropout& lost_before) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == slots_.size()) return false;
    FrameToRecord& slot = slots_[end % slots_.size()];
    slot.report = report;
    std::swap(slot.frame, frame);
    slot.ordinal = ordinal;
    slot.lost_before = lost_before;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }

  /// Null when there is none; valid until pop().
  const FrameToRecord* front() const {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return nullptr;
    return &slots_[begin % slots_.size()];
  }
  void pop() { begin_.fetch_add(1, std::memory_order_release); }

 private:
  std::vector<FrameToRecord> slots_;
  // Counted up for ever; on lines of their own, so that the threads do not slow each other.
  alignas(64) std::atomic<std::size_t> begin_{0};
  alignas(64) std::atomic<std::size_t> end_{0};
};

}  // namespace lsv
