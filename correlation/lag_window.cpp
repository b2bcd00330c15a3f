// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/lag_window.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lsv {
namespace {

/// The integer products hold 12 bits; of a deeper pixel the lowest bits, noise, are dropped.
constexpr int kProductBits = 12;

struct Sums {
  std::int64_t sum = 0;
  std::int64_t squares = 0;

  void add(std::int64_t count, int sign) {
    sum += sign * count;
    squares += sign * count * count;
  }
};

/// The region of the later frame at the middle lag; the other eight are its neighbours.
struct Region {
  int x_px, y_px, width_px, height_px;
};

/// Sums of the nine regions from those of the middle one: a region one px on loses a column or a
/// row on one side and gains one on the other.
template <typename Pixel>
std::array<Sums, 9> neighbour_sums(kernels::Plane<const Pixel> later, const Region& region,
                                   int drop_bits, const Sums& middle) {
  const auto count = [&](int x, int y) { return std::int64_t{*later.at(x, y) >> drop_bits}; };
  const int left = region.x_px, right = region.x_px + region.width_px;
  const int top = region.y_px, bottom = region.y_px + region.height_px;
  const auto row_sums = [&](int y) {
    Sums out;
    for (int x = left; x < right; ++x) out.add(count(x, y), 1);
    return out;
  };
  const auto column_sums = [&](int x) {
    Sums out;
    for (int y = top; y < bottom; ++y) out.add(count(x, y), 1);
    return out;
  };
  const std::array<int, 4> columns{left - 1, left, right - 1, right};
  const std::array<Sums, 4> down{column_sums(columns[0]), column_sums(columns[1]),
                                 column_sums(columns[2]), column_sums(columns[3])};
  std::array<Sums, 9> out;
  for (int j = -1; j <= 1; ++j) {
    const int row_gained = j < 0 ? top - 1 : bottom;
    const int row_lost = j < 0 ? bottom - 1 : top;
    Sums level = middle;
    if (j != 0) {
      const Sums gained = row_sums(row_gained), lost = row_sums(row_lost);
      level.sum += gained.sum - lost.sum;
      level.squares += gained.squares - lost.squares;
    }
    for (int i = -1; i <= 1; ++i) {
      Sums sums = level;
      const auto add_column = [&](std::size_t which, int sign) {
        sums.sum += sign * down[which].sum;
        sums.squares += sign * down[which].squares;
        if (j == 0) return;
        sums.add(count(columns[which], row_gained), sign);
        sums.add(count(columns[which], row_lost), -sign);
      };
      if (i != 0) {
        add_column(i < 0 ? 0 : 3, 1);   // gained
        add_column(i < 0 ? 2 : 1, -1);  // lost
      }
      out[static_cast<std::size_t>(3 * (j + 1) + i + 1)] = sums;
    }
  }
  return out;
}

/// Sum of squares about the mean.
double spread(const Sums& sums, double n) {
  const auto sum = static_cast<double>(sums.sum);
  return static_cast<double>(sums.squares) - sum * sum / n;
}

template <typename Pixel>
void fill(kernels::Plane<const Pixel> earlier, kernels::Plane<const Pixel> later,
          const Region& region, int drop_bits, LagWindow& out) {
  const kernels::LagProducts products = kernels::lag_products<Pixel>(
      {earlier.at(region.x_px - out.dx_px, region.y_px - out.dy_px), earlier.stride},
      {later.at(region.x_px, region.y_px), later.stride}, region.width_px, region.height_px,
      drop_bits);
  const std::array<Sums, 9> b =
      neighbour_sums(later, region, drop_bits, {products.later, products.later_squares});
  const Sums a{products.earlier, products.earlier_squares};
  const double n = static_cast<double>(region.width_px) * region.height_px;
  const double spread_a = spread(a, n);
  for (std::size_t k = 0; k < b.size(); ++k) {
    const double spread_b = spread(b[k], n);
    const double covariance = static_cast<double>(products.product[k]) -
                              static_cast<double>(a.sum) * static_cast<double>(b[k].sum) / n;
    const bool constant = !(std::min(spread_a, spread_b) > kConstantVariance_counts2 * n);
    out.zncc[k] = constant ? 0.0 : covariance / std::sqrt(spread_a * spread_b);
  }
  const double spread_b = spread(b[4], n);
  out.gain = spread_a > 0.0 && spread_b > 0.0 ? std::sqrt(spread_b / spread_a) : 1.0;
  out.offset_counts = (static_cast<double>(b[4].sum) - out.gain * static_cast<double>(a.sum)) / n *
                      static_cast<double>(1 << drop_bits);
  out.earlier_mean_counts = static_cast<double>(a.sum) / n * static_cast<double>(1 << drop_bits);
  out.overlap_px = n;
}

}  // namespace

bool lag_window_at(const TrackFrame& earlier, const TrackFrame& later, int dx_px, int dy_px,
                   LagWindow& out) {
  const FrameFormat& format = later.format();
  // All nine regions must lie inside the later frame, the common one inside the earlier.
  const int left = std::max(1, dx_px),
            right = std::min(format.width_px - 1, format.width_px + dx_px);
  const int top = std::max(1, dy_px),
            bottom = std::min(format.height_px - 1, format.height_px + dy_px);
  const Region region{left, top, right - left, bottom - top};
  if (region.width_px < kMinOverlap_px || region.height_px < kMinOverlap_px) return false;
  out.dx_px = dx_px;
  out.dy_px = dy_px;
  if (format.type == PixelType::mono8) {
    fill(earlier.pixels<std::uint8_t>(), later.pixels<std::uint8_t>(), region, 0, out);
  } else {
    fill(earlier.pixels<std::uint16_t>(), later.pixels<std::uint16_t>(), region,
         std::max(0, format.bit_depth - kProductBits), out);
  }
  return true;
}

LagWindow climb(const TrackFrame& earlier, const TrackFrame& later, int guess_dx_px,
                int guess_dy_px) {
  LagWindow out;
  int dx = guess_dx_px, dy = guess_dy_px;
  int last_dx = dx, last_dy = dy;
  for (int i = 0; i < kMaxClimbs; ++i) {
    if (!lag_window_at(earlier, later, dx, dy, out)) return out;
    std::size_t highest = 4;
    for (std::size_t k = 0; k < out.zncc.size(); ++k) {
      if (out.zncc[k] > out.zncc[highest]) highest = k;
    }
    const int next_dx = dx + static_cast<int>(highest % 3) - 1;
    const int next_dy = dy + static_cast<int>(highest / 3) - 1;
    // The windows of two lags that are equally high may each prefer the other: either will do.
    const bool back = i > 0 && next_dx == last_dx && next_dy == last_dy;
    if (highest == 4 || back) {
      out.found = true;
      return out;
    }
    last_dx = dx, last_dy = dy;
    dx = next_dx, dy = next_dy;
  }
  return out;
}

}  // namespace lsv
