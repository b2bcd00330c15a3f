// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/paced_source.h"

#include <cstring>
#include <mutex>
#include <utility>

namespace lsv {
namespace {

void copy_pixels(const FrameView& from, Frame& to) {
  to.reset(from.format);
  const std::size_t row_bytes =
      static_cast<std::size_t>(from.format.width_px) * bytes_per_pixel(from.format.type);
  for (int y = 0; y < from.format.height_px; ++y)
    std::memcpy(to.row(y), from.data + y * from.stride_bytes, row_bytes);
}

}  // namespace

PacedSource::PacedSource(Pictures pictures, const PacedOptions& options)
    : pictures_(std::move(pictures)), options_(options) {
  info_.description = "frames in memory";
  info_.format = pictures_(0).format;
  info_.period_ns = options.period_ns;
}

Result<Grab> PacedSource::grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) {
  const std::int64_t now_ns = host_now_ns();
  if (begin_ns_ == 0) begin_ns_ = now_ns + options_.period_ns;
  // Those that found no free buffer.
  const std::int64_t exposed = (now_ns - begin_ns_) / options_.period_ns + 1;
  if (now_ns >= begin_ns_ && exposed - next_ > options_.driver_buffers) {
    lost_ += exposed - options_.driver_buffers - next_;
    next_ = exposed - options_.driver_buffers;
  }
  if (next_ >= options_.frames) return Grab::ended;
  const std::int64_t due_ns = begin_ns_ + next_ * options_.period_ns;
  const bool is_due = due_ns <= now_ns + timeout_ns;
  if (!wait_until(is_due ? due_ns : now_ns + timeout_ns) || !is_due) return Grab::nothing;
  copy_pixels(pictures_(next_), out);
  out.stamp.ns = due_ns;
  out.index = next_;
  label = {
      .camera_id = static_cast<std::uint64_t>(next_), .camera_ns = due_ns, .arrival_ns = due_ns};
  ++next_;
  return Grab::frame;
}

bool PacedSource::wait_until(std::int64_t until_ns) {
  const std::lock_guard lock(mutex_);
  while (!stopped_ && host_now_ns() < until_ns) stopped_signal_.wait_until(mutex_, until_ns);
  return !stopped_;
}

void PacedSource::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  stopped_signal_.notify();
}

}  // namespace lsv
