// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/frame_ring.h"

#include <cstring>
#include <utility>

namespace lsv {

Frame touched_frame(const FrameFormat& format) {
  Frame out(format);
  const std::size_t row_bytes =
      static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
  for (int y = 0; y < format.height_px; ++y) std::memset(out.row(y), 0, row_bytes);
  return out;
}

FrameRing::FrameRing(std::size_t frames, const FrameFormat& format) : slots_(frames) {
  for (QueuedFrame& slot : slots_) slot.frame = touched_frame(format);
}

bool FrameRing::push(QueuedFrame& in) {
  const bool is_full = size_ == slots_.size();
  if (is_full) {
    advance();
    ++dropped_;
  }
  std::swap(slots_[(head_ + size_) % slots_.size()], in);
  ++size_;
  return is_full;
}

bool FrameRing::pop(QueuedFrame& out) {
  if (size_ == 0) return false;
  std::swap(slots_[head_], out);
  advance();
  return true;
}

std::int64_t FrameRing::clear() {
  const std::int64_t waited = size();
  dropped_ += waited;
  size_ = 0;
  return waited;
}

void FrameRing::advance() {
  head_ = (head_ + 1) % slots_.size();
  --size_;
}

}  // namespace lsv
