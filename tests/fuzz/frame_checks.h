// SPDX-License-Identifier: BSD-3-Clause
// What must hold for every frame that a decoder hands out.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "lsv/core/frame.h"

namespace lsv::fuzz {

/// `rule` says what must hold; the log of a failed run names it.
inline void require(bool holds, const char* rule) {
  if (holds) return;
  std::fprintf(stderr, "ERROR: does not hold: %s\n", rule);
  std::abort();
}

inline void check_format(const FrameFormat& format, std::int64_t max_pixels) {
  require(format.width_px > 0 && format.height_px > 0, "a frame holds a pixel");
  require(std::int64_t{format.width_px} * format.height_px <= max_pixels,
          "a frame is within the limit of pixels");
  if (format.type == PixelType::mono8) {
    require(format.bit_depth == 8, "bytes have 8 bits");
  } else {
    require(format.bit_depth >= 10 && format.bit_depth <= 16 && format.bit_depth % 2 == 0,
            "words have 10, 12, 14 or 16 bits");
  }
}

/// Large enough for any frame that is let through, every byte set to `value`. A decoder that
/// leaves pixels out gives different frames for different values.
inline void prefill(Frame& frame, int value, std::int64_t max_pixels) {
  frame.reset({.width_px = static_cast<int>(max_pixels),
               .height_px = 1,
               .type = PixelType::mono16,
               .bit_depth = 16});
  std::memset(frame.row(0), value, static_cast<std::size_t>(max_pixels) * 2);
}

inline bool same_frames(const FrameView& a, const FrameView& b) {
  if (a.format != b.format) return false;
  const std::size_t row_bytes =
      static_cast<std::size_t>(a.width_px()) * bytes_per_pixel(a.format.type);
  for (int y = 0; y < a.height_px(); ++y) {
    if (std::memcmp(a.data + y * a.stride_bytes, b.data + y * b.stride_bytes, row_bytes) != 0)
      return false;
  }
  return true;
}

}  // namespace lsv::fuzz
