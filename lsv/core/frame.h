// SPDX-License-Identifier: BSD-3-Clause
// One camera frame: FrameView borrows pixels, Frame owns them.
// Pixels are row-major, x = column to the right, y = row downwards, unsigned counts in 8- or
// 16-bit words of the machine's byte order. `bit_depth` says how many low bits of a word carry
// signal (8, 10, 12, 14 or 16), so full scale is 2^bit_depth - 1 and nothing is ever rescaled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "lsv/core/stamp.h"

namespace lsv {

enum class PixelType : std::uint8_t { mono8, mono16 };

inline constexpr std::size_t bytes_per_pixel(PixelType type) {
  return type == PixelType::mono8 ? 1 : 2;
}

/// A rectangle of pixels: columns [x_px, x_px + width_px), rows [y_px, y_px + height_px).
struct Roi {
  int x_px = 0;
  int y_px = 0;
  int width_px = 0;
  int height_px = 0;
  friend bool operator==(const Roi&, const Roi&) = default;
};

/// What must agree between the frames of one sequence.
struct FrameFormat {
  int width_px = 0;
  int height_px = 0;
  PixelType type = PixelType::mono8;
  int bit_depth = 8;
  friend bool operator==(const FrameFormat&, const FrameFormat&) = default;
};

/// Borrowed pixels; valid while the owner lives and is not written to. Freely copied.
struct FrameView {
  const std::byte* data = nullptr;
  std::ptrdiff_t stride_bytes = 0;
  FrameFormat format{};
  Stamp stamp{};           // middle of the exposure
  std::int64_t index = 0;  // position in the source; a missing frame leaves a hole

  int width_px() const { return format.width_px; }
  int height_px() const { return format.height_px; }

  const std::uint8_t* row8(int y_px) const {
    return reinterpret_cast<const std::uint8_t*>(data + y_px * stride_bytes);
  }
  const std::uint16_t* row16(int y_px) const {
    return reinterpret_cast<const std::uint16_t*>(data + y_px * stride_bytes);
  }
  /// Slow access for tests and reports.
  int at(int x_px, int y_px) const {
    return format.type == PixelType::mono8 ? row8(y_px)[x_px] : row16(y_px)[x_px];
  }
};

inline constexpr int full_scale_counts(int bit_depth) { return (1 << bit_depth) - 1; }

/// Whether a frame can look like this: sides of at least 1 px, and 8 bits in a byte or 9 to 16 in
/// a 16-bit word.
bool is_possible(const FrameFormat& format);

/// `roi` must lie inside the frame (contains()).
bool contains(const FrameFormat& format, const Roi& roi);
FrameView crop(const FrameView& frame, const Roi& roi);

/// Owner of one frame. Move-only: a copy of pixels is never made unasked. Rows start on 64-byte
/// boundaries. reset() allocates only when the frame grows.
class Frame {
 public:
  Frame() = default;
  explicit Frame(const FrameFormat& format) { reset(format); }

  void reset(const FrameFormat& format);

  std::byte* row(int y_px) { return pixels_.get() + y_px * stride_bytes_; }
  std::uint8_t* row8(int y_px) { return reinterpret_cast<std::uint8_t*>(row(y_px)); }
  std::uint16_t* row16(int y_px) { return reinterpret_cast<std::uint16_t*>(row(y_px)); }

  FrameView view() const {
    return {.data = pixels_.get(),
            .stride_bytes = stride_bytes_,
            .format = format_,
            .stamp = stamp,
            .index = index};
  }

  Stamp stamp;
  std::int64_t index = 0;

 private:
  struct Free {
    void operator()(std::byte* p) const;
  };
  std::unique_ptr<std::byte[], Free> pixels_;
  std::size_t capacity_bytes_ = 0;
  std::ptrdiff_t stride_bytes_ = 0;
  FrameFormat format_;
};

}  // namespace lsv
