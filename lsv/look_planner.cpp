// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/look_planner.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace lsv {
namespace {

// The first looks are taken as they come; later ones are spread, so that they take no time.
constexpr std::size_t kEagerLooks = 64;
constexpr int kFramesBetweenLooks = 16;

// Other ground: this share of the squared difference of two unrelated frames, which itself varies
// by a tenth. Speckle that is 0.2 correlated is as good as new.
constexpr double kOtherGround = 0.8;
// What unrelated frames differ by is forgotten slowly: it may have been a flash.
constexpr double kRemembered = 0.999;
// As many samples as there are speckles tell as much as all pixels.
constexpr int kSamplesPerSide = 32;

int step_for(const FrameFormat& format) {
  const int side_px = std::max(format.width_px, format.height_px);
  return std::max(1, (side_px + kSamplesPerSide - 1) / kSamplesPerSide);
}

template <typename Pixel>
void sample(const FrameView& from, int step_px, std::vector<std::uint16_t>& to) {
  auto next = to.begin();
  for (int y = 0; y < from.height_px(); y += step_px) {
    const auto* const row = reinterpret_cast<const Pixel*>(from.data + y * from.stride_bytes);
    for (int x = 0; x < from.width_px(); x += step_px) *next++ = row[x];
  }
}

}  // namespace

LookPlanner::LookPlanner(const FrameFormat& format) : sample_step_px_(step_for(format)) {
  const auto count = [this](int side_px) {
    return static_cast<std::size_t>((side_px + sample_step_px_ - 1) / sample_step_px_);
  };
  samples_.resize(count(format.width_px) * count(format.height_px));
  for (std::vector<std::uint16_t>& seen : seen_) seen.resize(samples_.size());
}

bool LookPlanner::waits() {
  return ++frames_since_look_ < (looks_ < kEagerLooks ? 1 : kFramesBetweenLooks);
}

bool LookPlanner::look() {
  ++looks_;
  frames_since_look_ = 0;
  return true;
}

bool LookPlanner::is_due(double x_px, double y_px, double apart_px) {
  if (waits()) return false;
  const auto known = std::min<std::size_t>(place_count_, places_.size());
  for (std::size_t i = 0; i < known; ++i) {
    if (std::hypot(x_px - places_[i].x_px, y_px - places_[i].y_px) < apart_px) return false;
  }
  places_[place_count_++ % places_.size()] = {x_px, y_px};
  return look();
}

void LookPlanner::take_samples(const FrameView& raw) {
  if (raw.format.type == PixelType::mono8)
    sample<std::uint8_t>(raw, sample_step_px_, samples_);
  else
    sample<std::uint16_t>(raw, sample_step_px_, samples_);
}

double LookPlanner::squared_difference(const std::vector<std::uint16_t>& earlier) const {
  std::int64_t out = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::int64_t difference = std::int64_t{samples_[i]} - earlier[i];
    out += difference * difference;
  }
  return static_cast<double>(out);
}

bool LookPlanner::is_due_by_change(const FrameView& raw) {
  if (waits()) return false;
  take_samples(raw);
  if (const std::size_t known = std::min(seen_count_, seen_.size()); known > 0) {
    double least = std::numeric_limits<double>::infinity();
    double sum = 0.0;
    for (std::size_t i = 0; i < known; ++i) {
      const double difference = squared_difference(seen_[i]);
      least = std::min(least, difference);
      sum += difference;
    }
    full_change_ = std::max(sum / static_cast<double>(known), kRemembered * full_change_);
    if (!(least > 0.0) || least < kOtherGround * full_change_) return false;
  }
  std::swap(seen_[seen_count_++ % seen_.size()], samples_);
  return look();
}

}  // namespace lsv
