// SPDX-License-Identifier: BSD-3-Clause
// Frame ids that wrap, unwrapped: how many frames one lies after the newest accepted, and whether
// it was seen before. A pure value, no threads.
#pragma once

#include <cstdint>

namespace lsv {

class FrameIds {
 public:
  /// Ids count to 2^bits - 1 and go on at 0, or at 1 when they skip zero. `bits` in [1, 64].
  FrameIds(int bits, bool skips_zero);

  /// Frames from the newest accepted id to this one, in (-half a turn, half a turn]; 1 for the
  /// first, and for the id 0 of a counter that skips it: such a frame has no id.
  std::int64_t step(std::uint64_t id) const;

  /// Whether the id that is `step` <= 0 after the newest was accepted; known for the last 64 ids.
  bool seen(std::int64_t step) const;

  /// This is the newest now, `step` > 0 after the one before.
  void accept(std::uint64_t id, std::int64_t step);

  /// An older id, `step` <= 0 after the newest, has come too late: its next copy is a duplicate.
  void mark(std::int64_t step);

  /// The counter has begun again: the next id follows nothing.
  void forget();

 private:
  std::uint64_t position(std::uint64_t id) const;

  std::uint64_t mask_;   // of the bits of an id
  std::uint64_t count_;  // different ids; 0 stands for 2^64
  bool skips_zero_;
  bool has_newest_ = false;
  std::uint64_t newest_ = 0;   // position of it in one turn
  std::uint64_t history_ = 0;  // bit k: the id k before the newest was seen
};

}  // namespace lsv
