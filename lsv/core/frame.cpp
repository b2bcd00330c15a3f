// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/frame.h"

#include <new>

namespace lsv {
namespace {
constexpr std::size_t kRowAlignment_bytes = 64;
}  // namespace

bool is_possible(const FrameFormat& format) {
  const bool depth_fits = format.type == PixelType::mono8
                              ? format.bit_depth == 8
                              : format.bit_depth > 8 && format.bit_depth <= 16;
  return format.width_px > 0 && format.height_px > 0 && depth_fits;
}

bool contains(const FrameFormat& format, const Roi& roi) {
  return roi.x_px >= 0 && roi.y_px >= 0 && roi.width_px > 0 && roi.height_px > 0 &&
         roi.width_px <= format.width_px - roi.x_px && roi.height_px <= format.height_px - roi.y_px;
}

FrameView crop(const FrameView& frame, const Roi& roi) {
  FrameView out = frame;
  out.data += roi.y_px * frame.stride_bytes +
              roi.x_px * static_cast<std::ptrdiff_t>(bytes_per_pixel(frame.format.type));
  out.format.width_px = roi.width_px;
  out.format.height_px = roi.height_px;
  return out;
}

void Frame::reset(const FrameFormat& format) {
  const std::size_t row_bytes =
      static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
  const std::size_t stride =
      (row_bytes + kRowAlignment_bytes - 1) / kRowAlignment_bytes * kRowAlignment_bytes;
  const std::size_t needed_bytes = stride * static_cast<std::size_t>(format.height_px);
  if (needed_bytes > capacity_bytes_) {
    pixels_.reset(static_cast<std::byte*>(
        ::operator new[](needed_bytes, std::align_val_t{kRowAlignment_bytes})));
    capacity_bytes_ = needed_bytes;
  }
  stride_bytes_ = static_cast<std::ptrdiff_t>(stride);
  format_ = format;
}

void Frame::Free::operator()(std::byte* p) const {
  ::operator delete[](p, std::align_val_t{kRowAlignment_bytes});
}

}  // namespace lsv
