// SPDX-License-Identifier: BSD-3-Clause
// One number that tells whether two frames have the same pixels: FNV-1a over them, row by row.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lsv/core/frame.h"

namespace lsv::cli {

inline std::uint64_t pixel_checksum(const FrameView& frame) {
  std::uint64_t hash = 0xCBF29CE484222325;
  const std::size_t row_bytes =
      static_cast<std::size_t>(frame.width_px()) * bytes_per_pixel(frame.format.type);
  for (int y = 0; y < frame.height_px(); ++y) {
    const std::byte* const row = frame.data + y * frame.stride_bytes;
    for (std::size_t i = 0; i < row_bytes; ++i)
      hash = (hash ^ static_cast<std::uint64_t>(row[i])) * 0x100000001B3;
  }
  return hash;
}

}  // namespace lsv::cli
