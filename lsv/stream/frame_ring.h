// SPDX-License-Identifier: BSD-3-Clause
// Frames that wait to be measured: a bounded queue of frames whose memory is there from the start.
// Frames are swapped in and out, never copied. Full: the oldest waiting frame makes room and is
// counted, because a measurement that is late is worth less than one that is missing.
// No lock of its own: its owner holds one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/stream/live_source.h"

namespace lsv {

struct QueuedFrame {
  Frame frame;
  FrameLabel label{};
  bool stamp_replaced = false;
  // Of the stream, up to this frame.
  std::int64_t missing_so_far = 0;
  std::int64_t rejected_so_far = 0;
};

class FrameRing {
 public:
  /// `frames` >= 1 of `format`, every page of them touched.
  FrameRing(std::size_t frames, const FrameFormat& format);

  /// `in` is left with another frame's memory. True when the oldest had to go.
  bool push(QueuedFrame& in);
  /// False when nothing waits.
  bool pop(QueuedFrame& out);
  /// Drops what waits; how many those were.
  std::int64_t clear();

  std::int64_t size() const { return static_cast<std::int64_t>(size_); }
  std::int64_t dropped() const { return dropped_; }

 private:
  void advance();

  std::vector<QueuedFrame> slots_;
  std::size_t head_ = 0;  // the oldest
  std::size_t size_ = 0;
  std::int64_t dropped_ = 0;
};

/// A frame whose pages are in memory.
Frame touched_frame(const FrameFormat& format);

}  // namespace lsv
