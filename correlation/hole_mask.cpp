// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/hole_mask.h"

#include <algorithm>

#include "correlation/speckle_kernel.h"

namespace lsv {
namespace {

// From the inner pixels of a hole: over its rim, and as far as the weights reach.
constexpr int kReach_px = 1 + std::max(kGradientReach_px, kKernelRight_px);

}  // namespace

HoleMask::HoleMask(const FrameFormat& format)
    : format_(format),
      near_(static_cast<std::size_t>(format.width_px) * static_cast<std::size_t>(format.height_px)),
      scratch_(near_.size()) {}

void HoleMask::set(const std::vector<std::uint8_t>& is_hole) {
  const int width = format_.width_px;
  const int height = format_.height_px;
  const auto index = [width](int x, int y) { return static_cast<std::size_t>(y * width + x); };
  // Beyond the edge of the frame nothing can be filled in from, either.
  const auto shows_nothing = [&](int x, int y) {
    return x < 0 || y < 0 || x >= width || y >= height || is_hole[index(x, y)] != 0;
  };
  std::fill(near_.begin(), near_.end(), std::uint8_t{0});
  std::fill(scratch_.begin(), scratch_.end(), std::uint8_t{0});
  empty_ = true;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool is_inner = shows_nothing(x, y) && shows_nothing(x - 1, y) &&
                            shows_nothing(x + 1, y) && shows_nothing(x, y - 1) &&
                            shows_nothing(x, y + 1);
      if (!is_inner) continue;
      empty_ = false;
      const int left = std::max(0, x - kReach_px);
      const int right = std::min(width - 1, x + kReach_px);
      std::fill_n(scratch_.begin() + static_cast<std::ptrdiff_t>(index(left, y)), right - left + 1,
                  std::uint8_t{1});
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int v = std::max(0, y - kReach_px); v <= std::min(height - 1, y + kReach_px); ++v) {
      for (int x = 0; x < width; ++x) near_[index(x, y)] |= scratch_[index(x, v)];
    }
  }
}

void HoleMask::apply(kernels::Plane<const float> values, const kernels::Region& region, int dx_px,
                     int dy_px, kernels::Plane<float> out) const {
  const std::ptrdiff_t width = format_.width_px;
  for (int y = region.y_px; y < region.y_px + region.height_px; ++y) {
    const std::uint8_t* const here = near_.data() + y * width + region.x_px;
    const std::uint8_t* const there = here + dy_px * width + dx_px;
    const float* const from = values.at(region.x_px, y);
    float* const to = out.at(region.x_px, y);
    for (int x = 0; x < region.width_px; ++x)
      to[x] = (here[x] | there[x]) != 0 ? kernels::kUnused : from[x];
  }
}

}  // namespace lsv
