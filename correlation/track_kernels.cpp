// SPDX-License-Identifier: BSD-3-Clause
// Highway re-includes this file once per instruction set (foreach_target), hence no include guard
// and the order of the includes below.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "correlation/track_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "correlation/track_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace lsv::kernels::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using ShortTag = hn::ScalableTag<std::int16_t>;
using WideTag = hn::RepartitionToWide<ShortTag>;

template <class D>
HWY_INLINE double Total(D d, hn::Vec<D> sums) {
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sums)));
}

HWY_INLINE std::int64_t TotalInt(WideTag d, hn::Vec<WideTag> sums) {
  HWY_ALIGN std::int32_t lanes[hn::MaxLanes(WideTag())];
  hn::Store(sums, d, lanes);
  std::int64_t out = 0;
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) out += lanes[i];
  return out;
}

/// 16-bit lanes of pixels that are at most 4095 counts after the shift.
HWY_INLINE hn::Vec<ShortTag> LoadShort(ShortTag d, const std::uint8_t* p, int) {
  return hn::PromoteTo(d, hn::LoadU(hn::Rebind<std::uint8_t, ShortTag>(), p));
}
HWY_INLINE hn::Vec<ShortTag> LoadShort(ShortTag d, const std::uint16_t* p, int drop_bits) {
  const hn::RebindToUnsigned<ShortTag> du;
  return hn::BitCast(d, hn::ShiftRightSame(hn::LoadU(du, p), drop_bits));
}

/// Adds two products to each 32-bit sum: of which lanes depends on the instruction set.
HWY_INLINE hn::Vec<WideTag> AddProducts(hn::Vec<ShortTag> a, hn::Vec<ShortTag> b,
                                        hn::Vec<WideTag> sum) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(WideTag(), hn::GetLane(sum) + std::int32_t{hn::GetLane(a)} * hn::GetLane(b));
#else
  auto odd = hn::Zero(WideTag());
  sum = hn::ReorderWidenMulAccumulate(WideTag(), a, b, sum, odd);
  // RearrangeToOddPlusEven, time after time, would gather all sums in one lane on NEON.
  return hn::Add(sum, odd);
#endif
}

/// How many products of `largest_counts` squared each 32-bit lane holds for certain.
constexpr int ProductsThatFit(std::int64_t largest_counts) {
  return static_cast<int>(2147483647 / (2 * largest_counts * largest_counts));
}

// ---------------------------------------------------------------------------------- copy and sum

CountSums CopyAndSum8(Plane<const std::uint8_t> from, int width_px, int height_px,
                      std::uint8_t full_scale_counts, Plane<std::uint8_t> to) {
  const ShortTag d;
  const WideTag dw;
  const hn::Rebind<std::uint8_t, ShortTag> d8;
  const int lanes = static_cast<int>(hn::Lanes(d));
  constexpr int kFit = ProductsThatFit(255);
  const auto below_full = hn::Set(d, static_cast<std::int16_t>(full_scale_counts - 1));
  const auto one = hn::Set(d, std::int16_t{1});
  CountSums out;
  auto sum = hn::Zero(dw);
  auto squares = hn::Zero(dw);
  auto saturated = hn::Zero(dw);
  int products = 0;
  const auto flush = [&] {
    out.sum_counts += static_cast<std::uint64_t>(TotalInt(dw, sum));
    out.sum_squares_counts2 += static_cast<std::uint64_t>(TotalInt(dw, squares));
    out.saturated += static_cast<std::uint64_t>(TotalInt(dw, saturated));
    sum = squares = saturated = hn::Zero(dw);
    products = 0;
  };
  for (int y = 0; y < height_px; ++y) {
    const std::uint8_t* HWY_RESTRICT row = from.at(0, y);
    std::uint8_t* HWY_RESTRICT copy = to.at(0, y);
    int x = 0;
    for (; x + lanes <= width_px; x += lanes) {
      if (products == kFit) flush();
      ++products;
      const auto bytes = hn::LoadU(d8, row + x);
      hn::StoreU(bytes, d8, copy + x);
      const auto v = hn::PromoteTo(d, bytes);
      sum = AddProducts(v, one, sum);
      squares = AddProducts(v, v, squares);
      saturated = AddProducts(hn::IfThenElseZero(hn::Gt(v, below_full), one), one, saturated);
    }
    for (; x < width_px; ++x) {
      copy[x] = row[x];
      out.sum_counts += row[x];
      out.sum_squares_counts2 += std::uint64_t{row[x]} * row[x];
      out.saturated += row[x] >= full_scale_counts ? 1 : 0;
    }
  }
  flush();
  return out;
}

CountSums CopyAndSum16(Plane<const std::uint16_t> from, int width_px, int height_px,
                       std::uint16_t full_scale_counts, Plane<std::uint16_t> to) {
  CountSums out;
  for (int y = 0; y < height_px; ++y) {
    const std::uint16_t* HWY_RESTRICT row = from.at(0, y);
    std::uint16_t* HWY_RESTRICT copy = to.at(0, y);
    std::uint64_t sum = 0, squares = 0, saturated = 0;
    for (int x = 0; x < width_px; ++x) {
      copy[x] = row[x];
      sum += row[x];
      squares += std::uint64_t{row[x]} * row[x];
      saturated += row[x] >= full_scale_counts ? 1 : 0;
    }
    out.sum_counts += sum;
    out.sum_squares_counts2 += squares;
    out.saturated += saturated;
  }
  return out;
}

// ------------------------------------------------------------------------------------ lag window

template <typename Pixel>
LagProducts LagProductsOf(Plane<const Pixel> earlier, Plane<const Pixel> later, int width_px,
                          int height_px, int drop_bits) {
  const ShortTag d;
  const WideTag dw;
  const int lanes = static_cast<int>(hn::Lanes(d));
  constexpr int kFit = ProductsThatFit(sizeof(Pixel) == 1 ? 255 : 4095);
  const auto one = hn::Set(d, std::int16_t{1});
  LagProducts out;
  auto p0 = hn::Zero(dw), p1 = p0, p2 = p0, p3 = p0, p4 = p0, p5 = p0, p6 = p0, p7 = p0, p8 = p0;
  auto sum_a = p0, sum_aa = p0, sum_b = p0, sum_bb = p0;
  int products = 0;
  const auto flush = [&] {
    std::int64_t* const p = out.product;
    p[0] += TotalInt(dw, p0), p[1] += TotalInt(dw, p1), p[2] += TotalInt(dw, p2);
    p[3] += TotalInt(dw, p3), p[4] += TotalInt(dw, p4), p[5] += TotalInt(dw, p5);
    p[6] += TotalInt(dw, p6), p[7] += TotalInt(dw, p7), p[8] += TotalInt(dw, p8);
    out.earlier += TotalInt(dw, sum_a), out.earlier_squares += TotalInt(dw, sum_aa);
    out.later += TotalInt(dw, sum_b), out.later_squares += TotalInt(dw, sum_bb);
    p0 = p1 = p2 = p3 = p4 = p5 = p6 = p7 = p8 = hn::Zero(dw);
    sum_a = sum_aa = sum_b = sum_bb = hn::Zero(dw);
    products = 0;
  };
  for (int y = 0; y < height_px; ++y) {
    const Pixel* HWY_RESTRICT a_row = earlier.at(0, y);
    const Pixel* HWY_RESTRICT above = later.at(0, y - 1);
    const Pixel* HWY_RESTRICT level = later.at(0, y);
    const Pixel* HWY_RESTRICT below = later.at(0, y + 1);
    for (int x = 0; x < width_px; x += lanes) {
      if (products == kFit) flush();
      ++products;
      auto a = LoadShort(d, a_row + x, drop_bits);
      auto b = LoadShort(d, level + x, drop_bits);
      auto ones = one;
      if (x + lanes > width_px) {
        const auto inside = hn::FirstN(d, static_cast<std::size_t>(width_px - x));
        a = hn::IfThenElseZero(inside, a);
        ones = hn::IfThenElseZero(inside, one);
        sum_bb = AddProducts(hn::IfThenElseZero(inside, b), b, sum_bb);
      } else {
        sum_bb = AddProducts(b, b, sum_bb);
      }
      sum_a = AddProducts(a, one, sum_a);
      sum_aa = AddProducts(a, a, sum_aa);
      sum_b = AddProducts(b, ones, sum_b);
      p0 = AddProducts(a, LoadShort(d, above + x - 1, drop_bits), p0);
      p1 = AddProducts(a, LoadShort(d, above + x, drop_bits), p1);
      p2 = AddProducts(a, LoadShort(d, above + x + 1, drop_bits), p2);
      p3 = AddProducts(a, LoadShort(d, level + x - 1, drop_bits), p3);
      p4 = AddProducts(a, b, p4);
      p5 = AddProducts(a, LoadShort(d, level + x + 1, drop_bits), p5);
      p6 = AddProducts(a, LoadShort(d, below + x - 1, drop_bits), p6);
      p7 = AddProducts(a, LoadShort(d, below + x, drop_bits), p7);
      p8 = AddProducts(a, LoadShort(d, below + x + 1, drop_bits), p8);
    }
  }
  flush();
  return out;
}

LagProducts LagProducts8(Plane<const std::uint8_t> earlier, Plane<const std::uint8_t> later,
                         int width_px, int height_px, int drop_bits) {
  return LagProductsOf(earlier, later, width_px, height_px, drop_bits);
}
LagProducts LagProducts16(Plane<const std::uint16_t> earlier, Plane<const std::uint16_t> later,
                          int width_px, int height_px, int drop_bits) {
  return LagProductsOf(earlier, later, width_px, height_px, drop_bits);
}

// ------------------------------------------------------------------------------------ probed rows

/// Pixels in steps of kProbeBits.
HWY_INLINE hn::Vec<ShortTag> LoadProbe(ShortTag d, const std::uint8_t* p, int, int) {
  return hn::ShiftLeft<kProbeBits - 8>(
      hn::PromoteTo(d, hn::LoadU(hn::Rebind<std::uint8_t, ShortTag>(), p)));
}
HWY_INLINE hn::Vec<ShortTag> LoadProbe(ShortTag d, const std::uint16_t* p, int left, int right) {
  const hn::RebindToUnsigned<ShortTag> du;
  return hn::BitCast(d, hn::ShiftRightSame(hn::ShiftLeftSame(hn::LoadU(du, p), left), right));
}

/// As many vectors of sums as a vector has lanes, one after the other, become the totals of each.
HWY_INLINE void Totals(WideTag d, std::int32_t* HWY_RESTRICT sums) {
#if HWY_TARGET != HWY_SCALAR
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t vectors = lanes; vectors > 1; vectors /= 2) {
    for (std::size_t i = 0; i < vectors; i += 2) {
      const auto a = hn::Load(d, sums + i * lanes), b = hn::Load(d, sums + (i + 1) * lanes);
      hn::Store(hn::Add(hn::ConcatEven(d, b, a), hn::ConcatOdd(d, b, a)), d, sums + i / 2 * lanes);
    }
  }
#else
  (void)d, (void)sums;
#endif
}

constexpr int kProbeSums = sizeof(ProbeHalf) / sizeof(std::int32_t);
/// Room for the vectors of both halves, and to make them a whole number of Totals().
constexpr std::size_t kProbeVectors = 2 * kProbeSums + hn::MaxLanes(WideTag());

template <typename Pixel>
HWY_INLINE void ProbeHalfOf(const std::int16_t* HWY_RESTRICT along_y,
                            const Pixel* HWY_RESTRICT earlier_above,
                            const Pixel* HWY_RESTRICT earlier_below, Plane<const Pixel> later,
                            int width_px, const ProbeMap& map, std::int32_t* HWY_RESTRICT sums) {
  const ShortTag d;
  const WideTag dw;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int left = std::max(0, kProbeBits - map.bit_depth);
  const int right = std::max(0, map.bit_depth - kProbeBits);
  const auto load = [&](const Pixel* p) { return LoadProbe(d, p, left, right); };
  constexpr std::int16_t kLargest = 2047;
  const auto largest = hn::Set(d, kLargest), least = hn::Set(d, std::int16_t{-kLargest});
  const auto clamped = [&](hn::Vec<ShortTag> v) { return hn::Min(hn::Max(v, least), largest); };
  const auto w0 = hn::Set(d, map.weights_x[0]), w1 = hn::Set(d, map.weights_x[1]);
  const auto w2 = hn::Set(d, map.weights_x[2]), w3 = hn::Set(d, map.weights_x[3]);
  const auto w4 = hn::Set(d, map.weights_x[4]), gain = hn::Set(d, map.gain_2048);
  const auto earlier_mean = hn::Set(d, map.earlier_mean), later_mean = hn::Set(d, map.later_mean);
  const auto one = hn::Set(d, std::int16_t{1});
  const Pixel* HWY_RESTRICT const above = later.at(0, -1);
  const Pixel* HWY_RESTRICT const level = later.at(0, 0);
  const Pixel* HWY_RESTRICT const below = later.at(0, 1);
  auto rx = hn::Zero(dw), ry = rx, xx = rx, xy = rx, yy = rx;
  auto rr = rx, rp = rx, pp = rx, sr = rx, sp = rx;
  for (int x = 0; x < width_px; x += lanes) {
    const auto scaled = [&](hn::Vec<ShortTag> a) { return hn::MulFixedPoint15(a, gain); };
    const auto gx_all = hn::SaturatedAdd(
        hn::Sub(load(level + x + 1), load(level + x - 1)),
        scaled(hn::Sub(hn::LoadU(d, along_y + x + 1), hn::LoadU(d, along_y + x - 1))));
    const auto gy_all = hn::SaturatedAdd(
        hn::Sub(load(below + x), load(above + x)),
        scaled(hn::ShiftLeft<4>(hn::Sub(load(earlier_below + x), load(earlier_above + x)))));
    auto gx = clamped(gx_all), gy = clamped(gy_all);
    const auto outer = hn::Add(hn::MulFixedPoint15(hn::LoadU(d, along_y + x - 2), w0),
                               hn::MulFixedPoint15(hn::LoadU(d, along_y + x + 2), w4));
    const auto inner = hn::Add(hn::MulFixedPoint15(hn::LoadU(d, along_y + x - 1), w1),
                               hn::MulFixedPoint15(hn::LoadU(d, along_y + x + 1), w3));
    const auto weighted =
        hn::Add(hn::Add(outer, inner), hn::MulFixedPoint15(hn::LoadU(d, along_y + x), w2));
    auto p = clamped(hn::Sub(hn::MulFixedPoint15(weighted, gain), earlier_mean));
    auto r = clamped(hn::Sub(hn::Sub(load(level + x), later_mean), p));
    auto ones = one;
    if (x + lanes > width_px) {
      const auto inside = hn::FirstN(d, static_cast<std::size_t>(width_px - x));
      gx = hn::IfThenElseZero(inside, gx), gy = hn::IfThenElseZero(inside, gy);
      p = hn::IfThenElseZero(inside, p), r = hn::IfThenElseZero(inside, r);
      ones = hn::IfThenElseZero(inside, one);
    }
    rx = AddProducts(r, gx, rx), ry = AddProducts(r, gy, ry);
    xx = AddProducts(gx, gx, xx), xy = AddProducts(gx, gy, xy), yy = AddProducts(gy, gy, yy);
    rr = AddProducts(r, r, rr), rp = AddProducts(r, p, rp), pp = AddProducts(p, p, pp);
    sr = AddProducts(r, ones, sr), sp = AddProducts(p, ones, sp);
  }
  const std::size_t step = hn::Lanes(dw);
  // In the order of ProbeHalf.
  hn::Store(rx, dw, sums);
  hn::Store(ry, dw, sums + step);
  hn::Store(xx, dw, sums + 2 * step);
  hn::Store(xy, dw, sums + 3 * step);
  hn::Store(yy, dw, sums + 4 * step);
  hn::Store(rr, dw, sums + 5 * step);
  hn::Store(rp, dw, sums + 6 * step);
  hn::Store(pp, dw, sums + 7 * step);
  hn::Store(sr, dw, sums + 8 * step);
  hn::Store(sp, dw, sums + 9 * step);
}

template <typename Pixel>
void ProbeRowsOf(Plane<const Pixel> earlier, Plane<const Pixel> later, int width_px, int count,
                 int step_rows, const ProbeMap& map, ProbedRow* rows) {
  const ShortTag d;
  const WideTag dw;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const std::size_t step = hn::Lanes(dw);
  const int left = std::max(0, kProbeBits - map.bit_depth);
  const int right = std::max(0, map.bit_depth - kProbeBits);
  const auto load = [&](const Pixel* p) { return hn::ShiftLeft<4>(LoadProbe(d, p, left, right)); };
  const auto w0 = hn::Set(d, map.weights_y[0]), w1 = hn::Set(d, map.weights_y[1]);
  const auto w2 = hn::Set(d, map.weights_y[2]), w3 = hn::Set(d, map.weights_y[3]);
  const auto w4 = hn::Set(d, map.weights_y[4]);
  const int half_px = probe_half_px(width_px);
  const int right_x = width_px - half_px;
  HWY_ALIGN std::int16_t along_y[2][kMostProbed_px + 2 * kProbeReach_px + hn::MaxLanes(ShortTag())];
  HWY_ALIGN std::int32_t sums[kProbeVectors * hn::MaxLanes(WideTag())] = {};
  for (int row = 0; row < count; ++row) {
    const int y = row * step_rows;
    for (int half = 0; half < 2; ++half) {
      const int begin = (half == 0 ? 0 : right_x) - kProbeReach_px;
      const auto at = [&](int row_above) { return earlier.at(begin, y + row_above); };
      const Pixel* const p0 = at(-2);
      const Pixel* const p1 = at(-1);
      const Pixel* const p2 = at(0);
      const Pixel* const p3 = at(1);
      const Pixel* const p4 = at(2);
      for (int x = 0; x < half_px + 2 * kProbeReach_px; x += lanes) {
        const auto outer =
            hn::Add(hn::MulFixedPoint15(load(p0 + x), w0), hn::MulFixedPoint15(load(p4 + x), w4));
        const auto inner =
            hn::Add(hn::MulFixedPoint15(load(p1 + x), w1), hn::MulFixedPoint15(load(p3 + x), w3));
        const auto sum = hn::Add(hn::Add(outer, inner), hn::MulFixedPoint15(load(p2 + x), w2));
        hn::StoreU(sum, d, along_y[half] + x);
      }
    }
    for (int half = 0; half < 2; ++half) {
      const int begin = half == 0 ? 0 : right_x;
      ProbeHalfOf<Pixel>(along_y[half] + kProbeReach_px, earlier.at(begin, y - 1),
                         earlier.at(begin, y + 1), {later.at(begin, y), later.stride}, half_px, map,
                         sums + static_cast<std::size_t>(half) * kProbeSums * step);
    }
    std::int32_t totals[kProbeVectors];
    for (std::size_t i = 0; i < 2 * kProbeSums; i += step) {
      Totals(dw, sums + i * step);
      hn::StoreU(hn::Load(dw, sums + i * step), dw, totals + i);
    }
    const auto half = [&](const std::int32_t* t) {
      return ProbeHalf{t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8], t[9]};
    };
    rows[row] = {half(totals), half(totals + kProbeSums)};
  }
}

void ProbeRows8(Plane<const std::uint8_t> earlier, Plane<const std::uint8_t> later, int width_px,
                int count, int step_rows, const ProbeMap& map, ProbedRow* rows) {
  ProbeRowsOf(earlier, later, width_px, count, step_rows, map, rows);
}
void ProbeRows16(Plane<const std::uint16_t> earlier, Plane<const std::uint16_t> later, int width_px,
                 int count, int step_rows, const ProbeMap& map, ProbedRow* rows) {
  ProbeRowsOf(earlier, later, width_px, count, step_rows, map, rows);
}

// ------------------------------------------------------------------------------------- gradients

void Derivative(Plane<const float> image, std::ptrdiff_t step, int width_px, int height_px,
                const std::array<float, kGradientReach_px>& weights_1_px, Plane<float> out) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto w1 = hn::Set(d, weights_1_px[0]), w2 = hn::Set(d, weights_1_px[1]);
  const auto w3 = hn::Set(d, weights_1_px[2]), w4 = hn::Set(d, weights_1_px[3]);
  for (int y = 0; y < height_px; ++y) {
    const float* HWY_RESTRICT row = image.at(0, y);
    float* HWY_RESTRICT to = out.at(0, y);
    for (int x = 0; x < width_px; x += lanes) {
      const float* const p = row + x;
      const auto difference = [&](std::ptrdiff_t k) {
        return hn::Sub(hn::LoadU(d, p + k * step), hn::LoadU(d, p - k * step));
      };
      auto sum = hn::Mul(w1, difference(1));
      sum = hn::MulAdd(w2, difference(2), sum);
      sum = hn::MulAdd(w3, difference(3), sum);
      sum = hn::MulAdd(w4, difference(4), sum);
      hn::StoreU(sum, d, to + x);
    }
  }
}

// ----------------------------------------------------------------------------- Gauss-Newton sums

/// The columns of a region in whole vectors, from an aligned one on.
struct Columns {
  int begin, end;

  template <class D>
  Columns(D d, const Region& region) : begin(0), end(region.x_px + region.width_px) {
    const int lanes = static_cast<int>(hn::Lanes(d));
    begin = region.x_px / lanes * lanes;
  }
};

/// inside[x - begin] = 1 for the columns of the region, 0 for those that round it to whole vectors.
HWY_INLINE void FillInside(const Columns& columns, const Region& region, int count, float* inside) {
  for (int i = 0; i < count; ++i)
    inside[i] = columns.begin + i >= region.x_px && columns.begin + i < columns.end ? 1.0F : 0.0F;
}

// Single-precision sums are moved to double after this many rows.
constexpr int kRowsPerFlush = 16;

/// Floats of one row of scratch: a row of the frame, the reach of the weights and a vector at
/// either end.
constexpr int ScratchStride(int width_px) { return (width_px + 191) / 64 * 64; }

/// 1 where a pixel of the reference counts, else 0.
HWY_INLINE hn::Vec<FloatTag> Weight(FloatTag d, hn::Vec<FloatTag> value, const float* inside) {
  const auto used = hn::Lt(value, hn::Set(d, 0.5F * kUnused));
  return hn::IfThenElseZero(used, hn::Load(d, inside));
}

ReferenceSums ReferenceSumsOf(const ReferencePlanes& reference, const Region& region,
                              float* HWY_RESTRICT inside) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Columns columns(d, region);
  FillInside(columns, region, columns.end - columns.begin + lanes, inside);
  ReferenceSums out;
  auto n = hn::Zero(d), v = n, vv = n, sx = n, sy = n, xv = n, yv = n, xx = n, xy = n, yy = n;
  auto next = n;
  const auto flush = [&] {
    out.n += Total(d, n), out.n_next_row += Total(d, next);
    out.v += Total(d, v), out.vv += Total(d, vv);
    out.x += Total(d, sx), out.y += Total(d, sy);
    out.xv += Total(d, xv), out.yv += Total(d, yv);
    out.xx += Total(d, xx), out.xy += Total(d, xy), out.yy += Total(d, yy);
    n = next = v = vv = sx = sy = xv = yv = xx = xy = yy = hn::Zero(d);
  };
  for (int row = 0; row < region.height_px; ++row) {
    const int y = region.y_px + row;
    const int below = row + 1 < region.height_px ? y + 1 : y;
    for (int x = columns.begin; x < columns.end; x += lanes) {
      const float* const in = inside + (x - columns.begin);
      const auto raw = hn::Load(d, reference.value.at(x, y));
      const auto weight = Weight(d, raw, in);
      const auto used = hn::Gt(weight, hn::Zero(d));
      const auto value = hn::IfThenElseZero(used, raw);
      const auto gx = hn::IfThenElseZero(used, hn::Load(d, reference.gx.at(x, y)));
      const auto gy = hn::IfThenElseZero(used, hn::Load(d, reference.gy.at(x, y)));
      n = hn::Add(n, weight);
      if (below != y)
        next = hn::MulAdd(weight, Weight(d, hn::Load(d, reference.value.at(x, below)), in), next);
      v = hn::Add(v, value);
      sx = hn::Add(sx, gx);
      sy = hn::Add(sy, gy);
      vv = hn::MulAdd(value, value, vv);
      xv = hn::MulAdd(gx, value, xv);
      yv = hn::MulAdd(gy, value, yv);
      xx = hn::MulAdd(gx, gx, xx);
      xy = hn::MulAdd(gx, gy, xy);
      yy = hn::MulAdd(gy, gy, yy);
    }
    if (row % kRowsPerFlush == kRowsPerFlush - 1) flush();
  }
  flush();
  return out;
}

/// Pixels of a row, scaled to kFixedPixelBits.
HWY_INLINE void ToFixed(const std::uint8_t* HWY_RESTRICT row, int n, int,
                        std::int16_t* HWY_RESTRICT out) {
  const ShortTag d;
  const hn::Rebind<std::uint8_t, ShortTag> d8;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < n; i += lanes)
    hn::StoreU(hn::ShiftLeft<kFixedPixelBits - 8>(hn::PromoteTo(d, hn::LoadU(d8, row + i))), d,
               out + i);
}
HWY_INLINE void ToFixed(const std::uint16_t* HWY_RESTRICT row, int n, int bit_depth,
                        std::int16_t* HWY_RESTRICT out) {
  const ShortTag d;
  const hn::RebindToUnsigned<ShortTag> du;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int left = std::max(0, kFixedPixelBits - bit_depth);
  const int right = std::max(0, bit_depth - kFixedPixelBits);
  for (int i = 0; i < n; i += lanes) {
    const auto v = hn::ShiftRightSame(hn::ShiftLeftSame(hn::LoadU(du, row + i), left), right);
    hn::StoreU(hn::BitCast(d, v), d, out + i);
  }
}

/// out[x] = sum over j of weights[j] in_j[x], in_j being `in(j)`, rounded after each product.
/// kFirst: the first weight that is not zero, 0 or 1; the last is its mirror image.
template <int kFirst, class Input>
HWY_INLINE void WeightedSum(const Input& in, int n, const FixedWeights& w,
                            std::int16_t* HWY_RESTRICT out) {
  const ShortTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const std::int16_t* const p0 = in(0);
  const std::int16_t* const p1 = in(1);
  const std::int16_t* const p2 = in(2);
  const std::int16_t* const p3 = in(3);
  const std::int16_t* const p4 = in(4);
  const std::int16_t* const p5 = in(5);
  const std::int16_t* const p6 = in(6);
  const std::int16_t* const p7 = in(7);
  const auto w0 = hn::Set(d, w[0]), w1 = hn::Set(d, w[1]), w2 = hn::Set(d, w[2]);
  const auto w3 = hn::Set(d, w[3]), w4 = hn::Set(d, w[4]), w5 = hn::Set(d, w[5]);
  const auto w6 = hn::Set(d, w[6]), w7 = hn::Set(d, w[7]);
  for (int x = 0; x < n; x += lanes) {
    const auto product = [&](hn::Vec<ShortTag> weight, const std::int16_t* p) {
      return hn::MulFixedPoint15(weight, hn::LoadU(d, p + x));
    };
    // The outer weights are small: only the last sums can exceed 16 bits, and they saturate.
    auto outer = hn::Add(hn::Add(product(w1, p1), product(w6, p6)),
                         hn::Add(product(w2, p2), product(w5, p5)));
    if (kFirst == 0) outer = hn::Add(outer, hn::Add(product(w0, p0), product(w7, p7)));
    const auto inner = hn::SaturatedAdd(product(w3, p3), product(w4, p4));
    hn::StoreU(hn::SaturatedAdd(inner, outer), d, out + x);
  }
}

/// kFirst: the first weight that is not zero, 0 or 1.
template <int kFirst, typename Pixel>
ResidualSums ResidualSumsOf(const ReferencePlanes& reference, Plane<const Pixel> later,
                            const Region& region, const Warp& warp, int stride,
                            float* HWY_RESTRICT scratch) {
  const FloatTag d;
  const IntTag di;
  const hn::Rebind<std::int16_t, FloatTag> d_short;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Columns columns(d, region);
  const int width = columns.end - columns.begin;
  float* HWY_RESTRICT const previous = scratch;  // residuals of the row above
  float* HWY_RESTRICT const inside = previous + stride;
  std::int16_t* const ring = reinterpret_cast<std::int16_t*>(inside + stride);  // rows of pixels
  std::int16_t* along_y = ring + kKernelTaps * stride;
  std::int16_t* next_along_y = along_y + stride;
  std::int16_t* const along_xy = next_along_y + stride;
  const Plane<const Pixel> moved{
      later.at(columns.begin + warp.whole_dx_px - kKernelLeft_px, region.y_px + warp.whole_dy_px),
      later.stride};
  const auto ring_row = [&](int y) {
    return ring + (y & (kKernelTaps - 1)) * std::ptrdiff_t{stride};
  };
  const auto fetch = [&](int y) {
    ToFixed(moved.at(0, y), width + kKernelTaps, warp.bit_depth, ring_row(y));
  };

  FillInside(columns, region, width + lanes, inside);
  std::fill_n(previous, stride, 0.0F);
  constexpr int kLast = kKernelTaps - 1 - kFirst;
  for (int y = kFirst - kKernelLeft_px; y < kLast - kKernelLeft_px; ++y) fetch(y);

  const auto interpolate_along_y = [&](int row, std::int16_t* to) {
    fetch(row + kLast - kKernelLeft_px);
    WeightedSum<kFirst>([&](int j) { return ring_row(row + j - kKernelLeft_px); },
                        width + kKernelTaps, warp.weights_y, to);
  };

  const auto counts_per_unit = hn::Set(d, std::ldexp(1.0F, warp.bit_depth - kFixedPixelBits));
  const auto gain = hn::Set(d, warp.gain);
  const auto minus_offset = hn::Set(d, -warp.offset_counts);
  ResidualSums out;
  auto r = hn::Zero(d), rr = r, rv = r, rx = r, ry = r, rn = r;
  auto few_rr = r, few_g = r, few_rrg = r, few_n = r;
  const auto flush = [&] {
    out.r += Total(d, r), out.rr += Total(d, rr), out.rv += Total(d, rv);
    out.rx += Total(d, rx), out.ry += Total(d, ry), out.rr_next_row += Total(d, rn);
    r = rr = rv = rx = ry = rn = hn::Zero(d);
  };
  interpolate_along_y(0, along_y);
  for (int row = 0; row < region.height_px; ++row) {
    // One row ahead: reading back at another alignment what was just written would stall.
    if (row + 1 < region.height_px) interpolate_along_y(row + 1, next_along_y);
    WeightedSum<kFirst>([&](int j) { return along_y + j; }, width, warp.weights_x, along_xy);
    const int y = region.y_px + row;
    const float* const values = reference.value.at(columns.begin, y);
    const float* const gxs = reference.gx.at(columns.begin, y);
    const float* const gys = reference.gy.at(columns.begin, y);
    for (int x = 0; x < width; x += lanes) {
      const auto value = hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(d_short, along_xy + x)));
      const auto v = hn::Load(d, values + x);
      const auto difference =
          hn::Sub(hn::MulAdd(value, counts_per_unit, minus_offset), hn::Mul(gain, v));
      const auto residual = hn::Mul(difference, Weight(d, v, inside + x));
      r = hn::Add(r, residual);
      rr = hn::MulAdd(residual, residual, rr);
      rv = hn::MulAdd(residual, v, rv);
      rx = hn::MulAdd(residual, hn::Load(d, gxs + x), rx);
      ry = hn::MulAdd(residual, hn::Load(d, gys + x), ry);
      rn = hn::MulAdd(residual, hn::Load(d, previous + x), rn);
      hn::Store(residual, d, previous + x);
    }
    for (int x = 0; row % kGradientRowStep == 0 && x < width; x += lanes) {
      const auto weight = Weight(d, hn::Load(d, values + x), inside + x);
      const auto gx = hn::Load(d, gxs + x);
      const auto gy = hn::Load(d, gys + x);
      const auto residual = hn::Load(d, previous + x);
      const auto g = hn::Mul(weight, hn::MulAdd(gx, gx, hn::Mul(gy, gy)));
      const auto square = hn::Mul(residual, residual);
      few_rr = hn::Add(few_rr, square);
      few_g = hn::Add(few_g, g);
      few_rrg = hn::MulAdd(square, g, few_rrg);
      few_n = hn::Add(few_n, weight);
    }
    std::swap(along_y, next_along_y);
    if (row % kRowsPerFlush == kRowsPerFlush - 1) flush();
  }
  flush();
  out.few_rr = Total(d, few_rr), out.few_g = Total(d, few_g);
  out.few_rrg = Total(d, few_rrg), out.few_n = Total(d, few_n);
  return out;
}

template <typename Pixel>
ResidualSums ResidualSumsFor(const ReferencePlanes& reference, Plane<const Pixel> later,
                             const Region& region, const Warp& warp, float* scratch) {
  const int stride = ScratchStride(region.width_px);
  if (warp.six_taps) return ResidualSumsOf<1>(reference, later, region, warp, stride, scratch);
  return ResidualSumsOf<0>(reference, later, region, warp, stride, scratch);
}

ResidualSums ResidualSums8(const ReferencePlanes& reference, Plane<const std::uint8_t> later,
                           const Region& region, const Warp& warp, float* scratch) {
  return ResidualSumsFor(reference, later, region, warp, scratch);
}
ResidualSums ResidualSums16(const ReferencePlanes& reference, Plane<const std::uint16_t> later,
                            const Region& region, const Warp& warp, float* scratch) {
  return ResidualSumsFor(reference, later, region, warp, scratch);
}

}  // namespace
}  // namespace lsv::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lsv::kernels {

HWY_EXPORT(CopyAndSum8);
HWY_EXPORT(CopyAndSum16);
HWY_EXPORT(LagProducts8);
HWY_EXPORT(LagProducts16);
HWY_EXPORT(ProbeRows8);
HWY_EXPORT(ProbeRows16);
HWY_EXPORT(Derivative);
HWY_EXPORT(ReferenceSumsOf);
HWY_EXPORT(ResidualSums8);
HWY_EXPORT(ResidualSums16);

template <>
CountSums copy_and_sum(Plane<const std::uint8_t> from, int width_px, int height_px,
                       std::uint8_t full_scale_counts, Plane<std::uint8_t> to) {
  return HWY_DYNAMIC_DISPATCH(CopyAndSum8)(from, width_px, height_px, full_scale_counts, to);
}
template <>
CountSums copy_and_sum(Plane<const std::uint16_t> from, int width_px, int height_px,
                       std::uint16_t full_scale_counts, Plane<std::uint16_t> to) {
  return HWY_DYNAMIC_DISPATCH(CopyAndSum16)(from, width_px, height_px, full_scale_counts, to);
}
template <>
LagProducts lag_products(Plane<const std::uint8_t> earlier, Plane<const std::uint8_t> later,
                         int width_px, int height_px, int drop_bits) {
  return HWY_DYNAMIC_DISPATCH(LagProducts8)(earlier, later, width_px, height_px, drop_bits);
}
template <>
LagProducts lag_products(Plane<const std::uint16_t> earlier, Plane<const std::uint16_t> later,
                         int width_px, int height_px, int drop_bits) {
  return HWY_DYNAMIC_DISPATCH(LagProducts16)(earlier, later, width_px, height_px, drop_bits);
}
template <>
void probe_rows(Plane<const std::uint8_t> earlier, Plane<const std::uint8_t> later, int width_px,
                int count, int step_rows, const ProbeMap& map, ProbedRow* rows) {
  HWY_DYNAMIC_DISPATCH(ProbeRows8)(earlier, later, width_px, count, step_rows, map, rows);
}
template <>
void probe_rows(Plane<const std::uint16_t> earlier, Plane<const std::uint16_t> later, int width_px,
                int count, int step_rows, const ProbeMap& map, ProbedRow* rows) {
  HWY_DYNAMIC_DISPATCH(ProbeRows16)(earlier, later, width_px, count, step_rows, map, rows);
}
void derivative(Plane<const float> image, std::ptrdiff_t step, int width_px, int height_px,
                const std::array<float, kGradientReach_px>& weights_1_px, Plane<float> out) {
  HWY_DYNAMIC_DISPATCH(Derivative)(image, step, width_px, height_px, weights_1_px, out);
}
ReferenceSums reference_sums(const ReferencePlanes& reference, const Region& region,
                             float* scratch) {
  return HWY_DYNAMIC_DISPATCH(ReferenceSumsOf)(reference, region, scratch);
}

std::size_t residual_scratch_size(int width_px) {
  // Two rows of floats and kKernelTaps + 3 of half their size.
  constexpr int kRows = 2 + (kKernelTaps + 4) / 2;
  return static_cast<std::size_t>(kRows * ((width_px + 191) / 64 * 64));
}

template <>
ResidualSums residual_sums(const ReferencePlanes& reference, Plane<const std::uint8_t> later,
                           const Region& region, const Warp& warp, float* scratch) {
  return HWY_DYNAMIC_DISPATCH(ResidualSums8)(reference, later, region, warp, scratch);
}
template <>
ResidualSums residual_sums(const ReferencePlanes& reference, Plane<const std::uint16_t> later,
                           const Region& region, const Warp& warp, float* scratch) {
  return HWY_DYNAMIC_DISPATCH(ResidualSums16)(reference, later, region, warp, scratch);
}

}  // namespace lsv::kernels
#endif  // HWY_ONCE
