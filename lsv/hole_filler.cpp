// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/hole_filler.h"

#include <cstddef>
#include <utility>

namespace lsv {
namespace {

constexpr int kFarthest_px = 255;

}  // namespace

HoleFiller::HoleFiller(const FrameFormat& format) : format_(format) {
  const auto pixels =
      static_cast<std::size_t>(format.width_px) * static_cast<std::size_t>(format.height_px);
  holes_.reserve(pixels);
  reach_px_.assign(pixels, Reach{});
}

void HoleFiller::set(const std::vector<std::uint8_t>& is_hole) {
  const int width = format_.width_px;
  const int height = format_.height_px;
  holes_.clear();
  const auto index = [width](int x, int y) { return static_cast<std::size_t>(y * width + x); };
  // Goes along a line from its end; the good pixel seen last is the nearest on that side.
  const auto sweep = [&](std::size_t side, int lines, int length, auto at) {
    for (int line = 0; line < lines; ++line) {
      int away = 0;
      for (int k = 0; k < length; ++k) {
        const std::size_t i = at(line, k);
        if (is_hole[i] == 0)
          away = 1;
        else if (away > 0 && away <= kFarthest_px)
          reach_px_[i][side] = static_cast<std::uint8_t>(away++);
        else
          reach_px_[i][side] = 0;
      }
    }
  };
  sweep(0, height, width, [&](int y, int k) { return index(k, y); });
  sweep(1, height, width, [&](int y, int k) { return index(width - 1 - k, y); });
  sweep(2, width, height, [&](int x, int k) { return index(x, k); });
  sweep(3, width, height, [&](int x, int k) { return index(x, height - 1 - k); });
  for (std::size_t i = 0; i < is_hole.size(); ++i) {
    if (is_hole[i] != 0) holes_.push_back(static_cast<std::int32_t>(i));
  }
}

void HoleFiller::fill(Frame& frame) const {
  if (format_.type == PixelType::mono8)
    fill_pixels<std::uint8_t>(frame);
  else
    fill_pixels<std::uint16_t>(frame);
}

template <typename Pixel>
void HoleFiller::fill_pixels(Frame& frame) const {
  const int width = format_.width_px;
  const auto at = [&](int x, int y) -> Pixel& { return reinterpret_cast<Pixel*>(frame.row(y))[x]; };
  for (const std::int32_t i : holes_) {
    const auto [left, right, up, down] = reach_px_[static_cast<std::size_t>(i)];
    const int x = i % width;
    const int y = i / width;
    float sum = 0.0F;
    float weight = 0.0F;
    const auto add = [&](int reach_px, int from_x, int from_y) {
      if (reach_px == 0) return;
      const float nearness = 1.0F / static_cast<float>(reach_px);
      sum += nearness * static_cast<float>(at(from_x, from_y));
      weight += nearness;
    };
    add(left, x - left, y);
    add(right, x + right, y);
    add(up, x, y - up);
    add(down, x, y + down);
    constexpr float kHalf = 0.5F;
    if (weight > 0.0F) at(x, y) = static_cast<Pixel>(static_cast<int>(sum / weight + kHalf));
  }
}

}  // namespace lsv
