// SPDX-License-Identifier: BSD-3-Clause
// Places of the sensor that show nothing of the ground and are too wide to be filled in from what
// is around them: what stands there in two frames is compared with nothing.
//
// Owns its memory, allocates at construction only; one object per thread.
#pragma once

#include <cstdint>
#include <vector>

#include "correlation/track_kernels.h"
#include "lsv/core/frame.h"

namespace lsv {

class HoleMask {
 public:
  HoleMask() = default;
  /// For frames of `format`, without holes so far.
  explicit HoleMask(const FrameFormat& format);

  /// `is_hole`: row-major, not 0 where a pixel shows nothing. Holes with a good pixel beside every
  /// one of theirs are narrow and do not count.
  void set(const std::vector<std::uint8_t>& is_hole);
  bool empty() const { return empty_; }

  /// Copies the values of `region`, but kUnused where the pixel, or the one (dx, dy) further on in
  /// the later frame, is so near to a hole that interpolation or differentiation would see it.
  void apply(kernels::Plane<const float> values, const kernels::Region& region, int dx_px,
             int dy_px, kernels::Plane<float> out) const;

 private:
  FrameFormat format_;
  std::vector<std::uint8_t> near_;
  std::vector<std::uint8_t> scratch_;
  bool empty_ = true;
};

}  // namespace lsv
