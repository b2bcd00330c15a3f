// SPDX-License-Identifier: BSD-3-Clause
// Pixels that tell nothing, filled from the nearest ones that do: left, right, above and below, the
// nearer the heavier. What fills a hole moves with the ground around it; a constant would not.
//
// Owns its memory, allocates at construction only; one object per thread.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lsv/core/frame.h"

namespace lsv {

class HoleFiller {
 public:
  HoleFiller() = default;
  /// For frames of `format`, without holes so far.
  explicit HoleFiller(const FrameFormat& format);

  /// `is_hole`: row-major, not 0 where a pixel tells nothing.
  void set(const std::vector<std::uint8_t>& is_hole);
  bool empty() const { return holes_.empty(); }

  /// `frame` has the format given at construction. A hole with no good pixel in its row and column
  /// stays as it is.
  void fill(Frame& frame) const;

 private:
  /// Steps to the nearest good pixel; 0: there is none, or it is too far to matter.
  using Reach = std::array<std::uint8_t, 4>;
  template <typename Pixel>
  void fill_pixels(Frame& frame) const;

  FrameFormat format_;
  std::vector<std::int32_t> holes_;
  std::vector<Reach> reach_px_;  // of each pixel that is a hole: left, right, up, down
};

}  // namespace lsv
