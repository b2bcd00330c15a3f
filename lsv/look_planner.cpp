// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/look_planner.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace lsv {
namespace {

// The first looks are taken as they come; later ones are spread, so that they take no time.
constexpr std::size_t kEagerLooks = 64;
constexpr int kFramesBetweenLooks = 16;

// Of the squared difference of two frames that share nothing but what stays.
constexpr double kAllChanged = 0.9;

void copy(const FrameView& from, Frame& to) {
  const auto row_bytes =
      static_cast<std::size_t>(from.width_px()) * bytes_per_pixel(from.format.type);
  for (int y = 0; y < from.height_px(); ++y)
    std::memcpy(to.row(y), from.data + y * from.stride_bytes, row_bytes);
}

template <typename Pixel>
double squared_difference(const FrameView& a, const FrameView& b) {
  double out = 0.0;
  for (int y = 0; y < a.height_px(); ++y) {
    const auto* const row_a = reinterpret_cast<const Pixel*>(a.data + y * a.stride_bytes);
    const auto* const row_b = reinterpret_cast<const Pixel*>(b.data + y * b.stride_bytes);
    std::int64_t row = 0;
    for (int x = 0; x < a.width_px(); ++x) {
      const std::int64_t difference = std::int64_t{row_a[x]} - row_b[x];
      row += difference * difference;
    }
    out += static_cast<double>(row);
  }
  return out;
}

double squared_difference(const FrameView& a, const FrameView& b) {
  return a.format.type == PixelType::mono8 ? squared_difference<std::uint8_t>(a, b)
                                           : squared_difference<std::uint16_t>(a, b);
}

}  // namespace

LookPlanner::LookPlanner(const FrameFormat& format)
    : first_changing_(format), last_changing_(format) {}

bool LookPlanner::waits() {
  return ++frames_since_look_ < (looks_ < kEagerLooks ? 1 : kFramesBetweenLooks);
}

bool LookPlanner::look() {
  ++looks_;
  frames_since_look_ = 0;
  return true;
}

bool LookPlanner::is_due(double x_px, double y_px, double apart_px) {
  changing_ = false;
  if (waits()) return false;
  const auto known = std::min<std::size_t>(place_count_, places_.size());
  for (std::size_t i = 0; i < known; ++i) {
    if (std::hypot(x_px - places_[i].x_px, y_px - places_[i].y_px) < apart_px) return false;
  }
  places_[place_count_++ % places_.size()] = {x_px, y_px};
  return look();
}

bool LookPlanner::is_due_by_change(const FrameView& raw) {
  if (waits()) return false;
  if (changing_) {
    const double since_last = squared_difference(raw, last_changing_.view());
    const double since_first = squared_difference(raw, first_changing_.view());
    if (!(since_last > 0.0) || since_last < kAllChanged * since_first) return false;
  } else {
    copy(raw, first_changing_);
  }
  changing_ = true;
  copy(raw, last_changing_);
  return look();
}

}  // namespace lsv
