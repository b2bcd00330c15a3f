// SPDX-License-Identifier: BSD-3-Clause
// Pairs of frames in a file, for programs on different machines of the same byte order: a header
// and the pixels of both frames, row by row without gaps; pair after pair to the end of the file.
#pragma once

#include <cstdint>
#include <istream>
#include <ostream>

#include "lsv/core/frame.h"

namespace lsv::test {

struct GuessedPair {
  Frame earlier;
  Frame later;
  double guess_dx_px = 0.0;
  double guess_dy_px = 0.0;
};

struct PairHeader {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::int32_t bit_depth = 0;
  std::int32_t unused = 0;
  double guess_dx_px = 0.0;
  double guess_dy_px = 0.0;
};

inline std::streamsize row_bytes(const FrameFormat& format) {
  return static_cast<std::streamsize>(bytes_per_pixel(format.type)) * format.width_px;
}

inline void write_pair(std::ostream& out, GuessedPair& pair) {
  const FrameFormat format = pair.earlier.view().format;
  const PairHeader header{.width_px = format.width_px,
                          .height_px = format.height_px,
                          .bit_depth = format.bit_depth,
                          .guess_dx_px = pair.guess_dx_px,
                          .guess_dy_px = pair.guess_dy_px};
  out.write(reinterpret_cast<const char*>(&header), sizeof header);
  for (Frame* frame : {&pair.earlier, &pair.later}) {
    for (int y = 0; y < format.height_px; ++y)
      out.write(reinterpret_cast<const char*>(frame->row(y)), row_bytes(format));
  }
}

/// False at the end of the file.
inline bool read_pair(std::istream& in, GuessedPair& pair) {
  PairHeader header;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return false;
  const FrameFormat format{.width_px = header.width_px,
                           .height_px = header.height_px,
                           .type = header.bit_depth == 8 ? PixelType::mono8 : PixelType::mono16,
                           .bit_depth = header.bit_depth};
  pair.guess_dx_px = header.guess_dx_px;
  pair.guess_dy_px = header.guess_dy_px;
  for (Frame* frame : {&pair.earlier, &pair.later}) {
    frame->reset(format);
    for (int y = 0; y < format.height_px; ++y)
      in.read(reinterpret_cast<char*>(frame->row(y)), row_bytes(format));
  }
  return static_cast<bool>(in);
}

}  // namespace lsv::test
