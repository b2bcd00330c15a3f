// SPDX-License-Identifier: BSD-3-Clause
// What one kind of input has to do: hand out whole frames in order. Selection, region of
// interest, time and the check that all frames agree are added once, by frame_source.cpp.
// Internal to lsv/: use frame_source.h.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"

namespace lsv {

/// Which indices are delivered: start, start + step, ... below stop.
struct FrameSelection {
  std::int64_t start = 0;
  std::optional<std::int64_t> stop = {};
  std::int64_t step = 1;

  bool past_end(std::int64_t index) const { return stop && index >= *stop; }
  bool takes(std::int64_t index) const {
    return index >= start && !past_end(index) && (index - start) % step == 0;
  }
  /// How many of the indices 0 .. count - 1 it takes.
  std::int64_t count_below(std::int64_t count) const {
    const std::int64_t end = stop ? std::min(*stop, count) : count;
    return end > start ? (end - 1 - start) / step + 1 : 0;
  }
};

class FrameStream {
 public:
  virtual ~FrameStream() = default;

  /// e.g. "PNG sequence"
  virtual std::string description() const = 0;
  /// The place to name in an error, e.g. "run.tif, page 3": of the frame read or skipped last.
  virtual std::string last_name() const = 0;
  /// The index that the next frame has, if there is one.
  virtual std::int64_t next_index() const = 0;

  /// The next frame, or false at the end.
  virtual Result<bool> read(Frame& out) = 0;
  /// Passes over the next frame as cheaply as the format allows, or false at the end.
  virtual Result<bool> skip() = 0;

  /// Indices of all frames in order, as a number when they are 0, 1, 2, ... and as a list when
  /// there are holes; neither when it cannot be known before the end.
  virtual std::optional<std::int64_t> count() const { return std::nullopt; }
  virtual const std::vector<std::int64_t>* indices() const { return nullptr; }

  /// Of the frame read last, for an input that knows when its frames were taken.
  virtual std::optional<Stamp> own_stamp() const { return std::nullopt; }

  /// Complete after the first read().
  virtual std::vector<std::string> warnings() const { return {}; }
};

}  // namespace lsv
