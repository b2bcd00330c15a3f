// SPDX-License-Identifier: BSD-3-Clause
// The scalar truth of track_kernels.h: what each kernel means, written to be read. Used by tests
// only. Sums of products are in double, so that they are exact next to the kernels' single ones.
#pragma once

#include <algorithm>
#include <cmath>

#include "correlation/track_kernels.h"

namespace lsv::kernels::ref {

template <typename Pixel>
CountSums copy_and_sum(Plane<const Pixel> from, int width_px, int height_px,
                       Pixel full_scale_counts, Plane<Pixel> to) {
  CountSums out;
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const std::uint64_t count = *from.at(x, y);
      *to.at(x, y) = *from.at(x, y);
      out.sum_counts += count;
      out.sum_squares_counts2 += count * count;
      out.saturated += count >= full_scale_counts ? 1 : 0;
    }
  }
  return out;
}

template <typename Pixel>
LagProducts lag_products(Plane<const Pixel> earlier, Plane<const Pixel> later, int width_px,
                         int height_px, int drop_bits) {
  LagProducts out;
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const std::int64_t a = *earlier.at(x, y) >> drop_bits;
      const std::int64_t middle = *later.at(x, y) >> drop_bits;
      out.earlier += a;
      out.earlier_squares += a * a;
      out.later += middle;
      out.later_squares += middle * middle;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i)
          out.product[3 * (j + 1) + i + 1] += a * (*later.at(x + i, y + j) >> drop_bits);
      }
    }
  }
  return out;
}

/// hwy::MulFixedPoint15: the product of two fractions in 1/32768, rounded to the nearest.
inline int product_15(int a, int b) { return (a * b + (1 << 14)) >> 15; }

/// What 16 bits hold.
inline int saturated(int value) { return std::clamp(value, -32768, 32767); }

inline int to_probe_bits(int count, int bit_depth) {
  return bit_depth > kProbeBits ? count >> (bit_depth - kProbeBits)
                                : count << (kProbeBits - bit_depth);
}

template <typename Pixel>
ProbeHalf probe_half(Plane<const Pixel> earlier, Plane<const Pixel> later, int width_px,
                     const ProbeMap& map) {
  const auto value = [&](int x, int y) { return to_probe_bits(*earlier.at(x, y), map.bit_depth); };
  const auto seen = [&](int x, int y) { return to_probe_bits(*later.at(x, y), map.bit_depth); };
  const auto weighted = [](const std::array<std::int16_t, kProbeTaps>& w, const auto& at) {
    int sum = 0;
    for (int k = -kProbeReach_px; k <= kProbeReach_px; ++k)
      sum += product_15(at(k), w[static_cast<std::size_t>(k + kProbeReach_px)]);
    return sum;
  };
  const auto along_y = [&](int x) {
    return weighted(map.weights_y, [&](int k) { return value(x, k) << 4; });
  };
  ProbeHalf out;
  for (int x = 0; x < width_px; ++x) {
    const auto slope = [&](int of_later, int of_earlier) {
      return std::clamp(of_later + product_15(of_earlier, map.gain_2048), -2047, 2047);
    };
    const int gx = slope(seen(x + 1, 0) - seen(x - 1, 0), along_y(x + 1) - along_y(x - 1));
    const int gy = slope(seen(x, 1) - seen(x, -1), (value(x, 1) - value(x, -1)) * 16);
    const int predicted =
        product_15(weighted(map.weights_x, [&](int k) { return along_y(x + k); }), map.gain_2048);
    const int p = std::clamp(predicted - map.earlier_mean, -2047, 2047);
    const int r = std::clamp(seen(x, 0) - map.later_mean - p, -2047, 2047);
    out.rx += r * gx, out.ry += r * gy;
    out.xx += gx * gx, out.xy += gx * gy, out.yy += gy * gy;
    out.rr += r * r, out.rp += r * p, out.pp += p * p;
    out.r += r, out.p += p;
  }
  return out;
}

template <typename Pixel>
void probe_rows(Plane<const Pixel> earlier, Plane<const Pixel> later, int width_px, int count,
                int step_rows, const ProbeMap& map, ProbedRow* rows) {
  const int half_px = probe_half_px(width_px);
  for (int row = 0; row < count; ++row) {
    const int y = row * step_rows;
    const auto half = [&](int x) {
      return probe_half<Pixel>({earlier.at(x, y), earlier.stride}, {later.at(x, y), later.stride},
                               half_px, map);
    };
    rows[row] = {half(0), half(width_px - half_px)};
  }
}

inline void derivative(Plane<const float> image, std::ptrdiff_t step, int width_px, int height_px,
                       const std::array<float, kGradientReach_px>& weights_1_px, Plane<float> out) {
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      double sum = 0.0;
      for (int k = 1; k <= kGradientReach_px; ++k) {
        const double right = image.at(x, y)[k * step];
        const double left = image.at(x, y)[-k * step];
        sum += weights_1_px[static_cast<std::size_t>(k - 1)] * (right - left);
      }
      *out.at(x, y) = static_cast<float>(sum);
    }
  }
}

inline bool is_used(const ReferencePlanes& reference, int x, int y) {
  return *reference.value.at(x, y) < 0.5F * kUnused;
}

inline ReferenceSums reference_sums(const ReferencePlanes& reference, const Region& region) {
  ReferenceSums out;
  const int bottom = region.y_px + region.height_px;
  for (int y = region.y_px; y < bottom; ++y) {
    for (int x = region.x_px; x < region.x_px + region.width_px; ++x) {
      if (!is_used(reference, x, y)) continue;
      const double v = *reference.value.at(x, y);
      const double gx = *reference.gx.at(x, y);
      const double gy = *reference.gy.at(x, y);
      out.n += 1.0;
      out.n_next_row += y + 1 < bottom && is_used(reference, x, y + 1) ? 1.0 : 0.0;
      out.v += v;
      out.vv += v * v;
      out.x += gx;
      out.y += gy;
      out.xv += gx * v;
      out.yv += gy * v;
      out.xx += gx * gx;
      out.xy += gx * gy;
      out.yy += gy * gy;
    }
  }
  return out;
}

/// A pixel as a number of kFixedPixelBits.
inline int to_fixed(int count, int bit_depth) {
  return bit_depth > kFixedPixelBits ? count >> (bit_depth - kFixedPixelBits)
                                     : count << (kFixedPixelBits - bit_depth);
}

/// Sum over j of weights[j] value(j). Only the sums of the inner two products can exceed 16 bits.
template <class Value>
int weighted_sum(const FixedWeights& weights, const Value& value) {
  const auto product = [&](int j) {
    return product_15(weights[static_cast<std::size_t>(j)], value(j));
  };
  const int inner = saturated(product(3) + product(4));
  int outer = 0;
  for (const int j : {0, 1, 2, 5, 6, 7}) outer += product(j);
  return saturated(inner + outer);
}

/// The later frame at pixel (x, y) of the reference, in 2^(bit_depth - kFixedPixelBits) counts:
/// interpolated along y, then along x.
template <typename Pixel>
int interpolated(Plane<const Pixel> later, const Warp& warp, int x, int y) {
  const int left = x + warp.whole_dx_px - kKernelLeft_px;
  const int top = y + warp.whole_dy_px - kKernelLeft_px;
  const auto along_y = [&](int i) {
    return weighted_sum(warp.weights_y, [&](int j) {
      return to_fixed(*later.at(left + i, top + j), warp.bit_depth);
    });
  };
  return weighted_sum(warp.weights_x, along_y);
}

/// later(x + shift) - gain * v - offset, 0 where the reference is not used.
template <typename Pixel>
double residual(const ReferencePlanes& reference, Plane<const Pixel> later, const Warp& warp, int x,
                int y) {
  if (!is_used(reference, x, y)) return 0.0;
  const double counts =
      std::ldexp(interpolated(later, warp, x, y), warp.bit_depth - kFixedPixelBits);
  return counts - warp.offset_counts - static_cast<double>(warp.gain) * *reference.value.at(x, y);
}

template <typename Pixel>
ResidualSums residual_sums(const ReferencePlanes& reference, Plane<const Pixel> later,
                           const Region& region, const Warp& warp) {
  ResidualSums out;
  for (int x = region.x_px; x < region.x_px + region.width_px; ++x) {
    double above = 0.0;
    for (int row = 0; row < region.height_px; ++row) {
      const int y = region.y_px + row;
      const double r = residual(reference, later, warp, x, y);
      out.rr_next_row += r * above;
      above = r;
      if (!is_used(reference, x, y)) continue;
      const double gx = *reference.gx.at(x, y);
      const double gy = *reference.gy.at(x, y);
      out.r += r;
      out.rr += r * r;
      out.rv += r * *reference.value.at(x, y);
      out.rx += r * gx;
      out.ry += r * gy;
      if (row % kGradientRowStep != 0) continue;
      const double g = gx * gx + gy * gy;
      out.few_n += 1.0;
      out.few_rr += r * r;
      out.few_g += g;
      out.few_rrg += r * r * g;
    }
  }
  return out;
}

}  // namespace lsv::kernels::ref
