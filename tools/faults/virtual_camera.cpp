// SPDX-License-Identifier: BSD-3-Clause
#include "tools/faults/virtual_camera.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace lsv::faults {

void VirtualClock::advance_to(std::int64_t ns) { now_ns_ = std::max(now_ns_.load(), ns); }

VirtualCamera::VirtualCamera(VirtualClock& clock, LiveSourceInfo info, Pictures pictures,
                             std::vector<Delivery> deliveries)
    : clock_(clock),
      info_(std::move(info)),
      pictures_(std::move(pictures)),
      deliveries_(std::move(deliveries)) {}

Result<Grab> VirtualCamera::grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) {
  if (next_ >= deliveries_.size()) {
    if (!error_.empty()) return Error{ErrorCode::bad_input, error_};
    return Grab::ended;
  }
  const Delivery& delivery = deliveries_[next_];
  const std::int64_t latest_ns = clock_.now_ns() + timeout_ns;
  if (delivery.label.arrival_ns > latest_ns) {
    clock_.advance_to(latest_ns);
    return Grab::nothing;
  }
  clock_.advance_to(delivery.label.arrival_ns);
  label = delivery.label;
  show(delivery, out);
  ++next_;
  return Grab::frame;
}

void VirtualCamera::show(const Delivery& delivery, Frame& out) {
  const FrameFormat format = delivery.format.value_or(info_.format);
  out.reset(format);
  const std::size_t row_bytes =
      static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
  if (delivery.format) {
    for (int y = 0; y < format.height_px; ++y) std::memset(out.row(y), 0, row_bytes);
  } else {
    const FrameView picture = pictures_(delivery.picture);
    for (int y = 0; y < format.height_px; ++y)
      std::memcpy(out.row(y), picture.data + y * picture.stride_bytes, row_bytes);
  }
  if (delivery.spoil) delivery.spoil(out);
}

bool VirtualCamera::reopen() {
  ++reopen_requests_;
  return reopens_;
}

}  // namespace lsv::faults
