// SPDX-License-Identifier: BSD-3-Clause
// Highway re-includes this file once per instruction set (foreach_target), hence no include guard
// and the order of the includes below.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "correlation/kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <cmath>

#include "correlation/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace lsv::kernels::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

const char* Target() { return hwy::TargetName(HWY_TARGET); }

template <typename Pixel>
RowSums RowSumsOf(const Pixel* HWY_RESTRICT row, std::size_t n, Pixel full_scale_counts) {
  const hn::ScalableTag<std::uint32_t> d;
  const hn::Rebind<Pixel, decltype(d)> d_pixel;
  const std::size_t lanes = hn::Lanes(d);
  const auto full = hn::Set(d, full_scale_counts);
  // 32768 pixels of 65535 counts are the most that a u32 sum is sure to hold.
  constexpr std::size_t kBlock = 32768;
  RowSums out;
  std::size_t i = 0;
  while (i + lanes <= n) {
    const std::size_t block_end = n - i > kBlock ? i + kBlock : n;
    auto sum = hn::Zero(d);
    auto saturated = hn::Zero(d);
    for (; i + lanes <= block_end; i += lanes) {
      const auto value = hn::PromoteTo(d, hn::LoadU(d_pixel, row + i));
      sum = hn::Add(sum, value);
      saturated = hn::Sub(saturated, hn::VecFromMask(d, hn::Eq(hn::Min(value, full), full)));
    }
    out.sum_counts += hn::GetLane(hn::SumOfLanes(d, sum));
    out.saturated += hn::GetLane(hn::SumOfLanes(d, saturated));
  }
  for (; i < n; ++i) {
    out.sum_counts += row[i];
    out.saturated += row[i] >= full_scale_counts ? 1 : 0;
  }
  return out;
}

template <typename Pixel>
void CentreRow(const Pixel* HWY_RESTRICT row, std::size_t n, float mean_counts,
               float* HWY_RESTRICT out) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> d_int;
  const hn::Rebind<Pixel, decltype(d)> d_pixel;
  const std::size_t lanes = hn::Lanes(d);
  const auto mean = hn::Set(d, mean_counts);
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes) {
    const auto value = hn::ConvertTo(d, hn::PromoteTo(d_int, hn::LoadU(d_pixel, row + i)));
    hn::StoreU(hn::Sub(value, mean), d, out + i);
  }
  for (; i < n; ++i) out[i] = static_cast<float>(row[i]) - mean_counts;
}

RowSums RowSums8(const std::uint8_t* row, std::size_t n, std::uint8_t full_scale_counts) {
  return RowSumsOf(row, n, full_scale_counts);
}
RowSums RowSums16(const std::uint16_t* row, std::size_t n, std::uint16_t full_scale_counts) {
  return RowSumsOf(row, n, full_scale_counts);
}
void Centre8(const std::uint8_t* row, std::size_t n, float mean_counts, float* out) {
  CentreRow(row, n, mean_counts, out);
}
void Centre16(const std::uint16_t* row, std::size_t n, float mean_counts, float* out) {
  CentreRow(row, n, mean_counts, out);
}

void AccumulateColumns(const float* HWY_RESTRICT first_row, std::ptrdiff_t stride, std::size_t rows,
                       std::size_t n, double sign, double* HWY_RESTRICT sum,
                       double* HWY_RESTRICT sum_sq) {
  const float* const end = first_row + static_cast<std::ptrdiff_t>(rows) * stride;
  std::size_t i = 0;
#if HWY_HAVE_FLOAT64
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> d_float;
  const std::size_t lanes = hn::Lanes(d);
  const auto signs = hn::Set(d, sign);
  for (; i + lanes <= n; i += lanes) {
    auto sums = hn::LoadU(d, sum + i);
    auto squares = hn::LoadU(d, sum_sq + i);
    for (const float* row = first_row; row != end; row += stride) {
      const auto value = hn::PromoteTo(d, hn::LoadU(d_float, row + i));
      const auto signed_value = hn::Mul(signs, value);
      sums = hn::Add(sums, signed_value);
      // A double holds the square of a float exactly: fused or not, the sum is the same.
      squares = hn::MulAdd(signed_value, value, squares);
    }
    hn::StoreU(sums, d, sum + i);
    hn::StoreU(squares, d, sum_sq + i);
  }
#endif
  for (; i < n; ++i) {
    for (const float* row = first_row; row != end; row += stride) {
      const double value = row[i];
      sum[i] += sign * value;
      sum_sq[i] += sign * (value * value);
    }
  }
}

double Sum(const double* HWY_RESTRICT values, std::size_t n) {
  double out = 0.0;
  std::size_t i = 0;
#if HWY_HAVE_FLOAT64
  const hn::ScalableTag<double> d;
  const std::size_t lanes = hn::Lanes(d);
  auto sums = hn::Zero(d);
  for (; i + lanes <= n; i += lanes) sums = hn::Add(sums, hn::LoadU(d, values + i));
  out = hn::GetLane(hn::SumOfLanes(d, sums));
#endif
  for (; i < n; ++i) out += values[i];
  return out;
}

void OverlapTerms(const double* HWY_RESTRICT sum, const double* HWY_RESTRICT sum_sq,
                  const double* HWY_RESTRICT inv_root_cols, double inv_root_rows, double min_spread,
                  std::size_t n, float* HWY_RESTRICT mean_root, float* HWY_RESTRICT inv_norm) {
  std::size_t i = 0;
#if HWY_HAVE_FLOAT64
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> d_float;
  const std::size_t lanes = hn::Lanes(d);
  const auto rows = hn::Set(d, inv_root_rows);
  const auto least = hn::Set(d_float, static_cast<float>(min_spread));
  const auto one = hn::Set(d_float, 1.0F);
  for (; i + lanes <= n; i += lanes) {
    const auto root =
        hn::Mul(hn::LoadU(d, sum + i), hn::Mul(hn::LoadU(d, inv_root_cols + i), rows));
    const auto difference = hn::Sub(hn::LoadU(d, sum_sq + i), hn::Mul(root, root));
    const auto spread = hn::DemoteTo(d_float, difference);
    const auto has_pattern = hn::Gt(spread, least);
    // Lanes without a pattern take the root of 1, not of a rounded-off negative.
    const auto norm = hn::Div(one, hn::Sqrt(hn::IfThenElse(has_pattern, spread, one)));
    hn::StoreU(hn::DemoteTo(d_float, root), d_float, mean_root + i);
    hn::StoreU(hn::IfThenElseZero(has_pattern, norm), d_float, inv_norm + i);
  }
#endif
  for (; i < n; ++i) {
    const double root = sum[i] * (inv_root_cols[i] * inv_root_rows);
    const auto spread = static_cast<float>(sum_sq[i] - root * root);
    mean_root[i] = static_cast<float>(root);
    inv_norm[i] = spread > static_cast<float>(min_spread) ? 1.0F / std::sqrt(spread) : 0.0F;
  }
}

void Interleave(const float* HWY_RESTRICT re, const float* HWY_RESTRICT im, std::size_t n,
                std::complex<float>* HWY_RESTRICT out) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  float* const po = reinterpret_cast<float*>(out);
  for (; i + lanes <= n; i += lanes)
    hn::StoreInterleaved2(hn::LoadU(d, re + i), hn::LoadU(d, im + i), d, po + 2 * i);
#endif
  for (; i < n; ++i) out[i] = {re[i], im[i]};
}

void Deinterleave(const std::complex<float>* HWY_RESTRICT z, std::size_t n, float* HWY_RESTRICT re,
                  float* HWY_RESTRICT im) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  const float* const pz = reinterpret_cast<const float*>(z);
  for (; i + lanes <= n; i += lanes) {
    hn::Vec<decltype(d)> re_lanes, im_lanes;
    hn::LoadInterleaved2(d, pz + 2 * i, re_lanes, im_lanes);
    hn::StoreU(re_lanes, d, re + i);
    hn::StoreU(im_lanes, d, im + i);
  }
#endif
  for (; i < n; ++i) {
    re[i] = z[i].real();
    im[i] = z[i].imag();
  }
}

// The spectra of a pair of rows: two neighbouring columns at a time in 128-bit vectors, which is as
// wide as the neighbours A[k] and B[k] in memory.

void UnpackPairSpectrum(const std::complex<float>* HWY_RESTRICT z, std::size_t n,
                        std::ptrdiff_t stride, std::complex<float>* HWY_RESTRICT out) {
  const auto unpack = [=](std::size_t k) {
    const std::complex<float> mirrored = std::conj(z[k == 0 ? 0 : n - k]);
    const std::complex<float> difference = z[k] - mirrored;
    std::complex<float>* const to = out + static_cast<std::ptrdiff_t>(k) * stride;
    to[0] = 0.5F * (z[k] + mirrored);
    to[1] = {0.5F * difference.imag(), -0.5F * difference.real()};
  };
  unpack(0);
  std::size_t k = 1;
#if HWY_TARGET != HWY_SCALAR
  const hn::FixedTag<float, 4> d;
  const hn::RepartitionToWide<decltype(d)> d_pair;
  HWY_ALIGN constexpr float kConj[4] = {1.0F, -1.0F, 1.0F, -1.0F};
  const auto conj = hn::Load(d, kConj);
  const auto halves = hn::Set(d, 0.5F);
  const auto half_conj = hn::Mul(halves, conj);
  for (; k + 2 <= n / 2; k += 2) {
    const auto here = hn::LoadU(d, reinterpret_cast<const float*>(z + k));
    const auto there = hn::LoadU(d, reinterpret_cast<const float*>(z + (n - k - 1)));
    const auto mirrored = hn::Mul(hn::Shuffle1032(there), conj);
    const auto a = hn::BitCast(d_pair, hn::Mul(halves, hn::Add(here, mirrored)));
    const auto difference = hn::Shuffle2301(hn::Sub(here, mirrored));
    const auto b = hn::BitCast(d_pair, hn::Mul(half_conj, difference));
    float* const to = reinterpret_cast<float*>(out + static_cast<std::ptrdiff_t>(k) * stride);
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(d_pair, a, b)), d, to);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(d_pair, a, b)), d, to + 2 * stride);
  }
#endif
  for (; k <= n / 2; ++k) unpack(k);
}

void PackPairSpectrum(const std::complex<float>* HWY_RESTRICT in, std::ptrdiff_t stride,
                      std::size_t n, std::complex<float>* HWY_RESTRICT z) {
  const auto pack = [=](std::size_t k) {
    const std::complex<float>* const from = in + static_cast<std::ptrdiff_t>(k) * stride;
    const std::complex<float> i_b(-from[1].imag(), from[1].real());
    z[k == 0 ? 0 : n - k] = std::conj(from[0] - i_b);
    z[k] = from[0] + i_b;
  };
  pack(0);
  std::size_t k = 1;
#if HWY_TARGET != HWY_SCALAR
  const hn::FixedTag<float, 4> d;
  const hn::RepartitionToWide<decltype(d)> d_pair;
  HWY_ALIGN constexpr float kConj[4] = {1.0F, -1.0F, 1.0F, -1.0F};
  const auto conj = hn::Load(d, kConj);
  for (; k + 2 <= n / 2; k += 2) {
    const float* const from =
        reinterpret_cast<const float*>(in + static_cast<std::ptrdiff_t>(k) * stride);
    const auto here = hn::BitCast(d_pair, hn::LoadU(d, from));
    const auto next = hn::BitCast(d_pair, hn::LoadU(d, from + 2 * stride));
    const auto a = hn::BitCast(d, hn::InterleaveLower(d_pair, here, next));
    const auto b = hn::BitCast(d, hn::InterleaveUpper(d_pair, here, next));
    const auto minus_i_b = hn::Mul(hn::Shuffle2301(b), conj);
    hn::StoreU(hn::Sub(a, minus_i_b), d, reinterpret_cast<float*>(z + k));
    const auto mirrored = hn::Mul(hn::Add(a, minus_i_b), conj);
    hn::StoreU(hn::Shuffle1032(mirrored), d, reinterpret_cast<float*>(z + (n - k - 1)));
  }
#endif
  for (; k <= n / 2; ++k) pack(k);
}

void MultiplyConj(const std::complex<float>* a, const std::complex<float>* b, std::size_t n,
                  std::complex<float>* out) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<float> d;
  const std::size_t values = hn::Lanes(d) / 2;
  const auto odd = hn::OddEven(hn::Set(d, -0.0F), hn::Zero(d));  // the sign bit of each im
  for (; i + values <= n; i += values) {
    const auto va = hn::LoadU(d, reinterpret_cast<const float*>(a + i));
    const auto vb = hn::LoadU(d, reinterpret_cast<const float*>(b + i));
    const auto crossed = hn::Mul(hn::DupOdd(va), hn::Shuffle2301(vb));
    const auto product = hn::Add(hn::Mul(hn::DupEven(va), vb), hn::Xor(crossed, odd));
    hn::StoreU(product, d, reinterpret_cast<float*>(out + i));
  }
#endif
  // One-lane vectors, not plain floats: where the target has FMA, g++ 12 fuses the plain
  // expression in spite of -ffp-contract=off and the tail would differ from the body.
  const hn::CappedTag<float, 1> d1;
  for (; i < n; ++i) {
    const auto a_re = hn::Set(d1, a[i].real());
    const auto a_im = hn::Set(d1, a[i].imag());
    const auto b_re = hn::Set(d1, b[i].real());
    const auto b_im = hn::Set(d1, b[i].imag());
    const auto re = hn::Add(hn::Mul(a_re, b_re), hn::Mul(a_im, b_im));
    const auto im = hn::Sub(hn::Mul(a_re, b_im), hn::Mul(a_im, b_re));
    out[i] = {hn::GetLane(re), hn::GetLane(im)};
  }
}

void NormaliseOverlap(float* HWY_RESTRICT plane, std::size_t n, float scale,
                      const float* HWY_RESTRICT mean_root_a, const float* HWY_RESTRICT inv_norm_a,
                      const float* HWY_RESTRICT mean_root_b, const float* HWY_RESTRICT inv_norm_b) {
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto scales = hn::Set(d, scale);
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes) {
    const std::size_t r = n - i - lanes;
    const auto mean_a = hn::Reverse(d, hn::LoadU(d, mean_root_a + r));
    const auto norm_a = hn::Reverse(d, hn::LoadU(d, inv_norm_a + r));
    const auto mean_b = hn::LoadU(d, mean_root_b + i);
    const auto norm_b = hn::LoadU(d, inv_norm_b + i);
    const auto product = hn::Sub(hn::Mul(scales, hn::LoadU(d, plane + i)), hn::Mul(mean_a, mean_b));
    hn::StoreU(hn::Mul(product, hn::Mul(norm_a, norm_b)), d, plane + i);
  }
  for (; i < n; ++i) {
    const std::size_t r = n - 1 - i;
    const float product = scale * plane[i] - mean_root_a[r] * mean_root_b[i];
    plane[i] = product * (inv_norm_a[r] * inv_norm_b[i]);
  }
}

float MaxValue(const float* HWY_RESTRICT values, std::size_t n) {
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  float largest = values[0];
  std::size_t i = 0;
  if (n >= lanes) {
    auto max = hn::LoadU(d, values);
    for (i = lanes; i + lanes <= n; i += lanes) max = hn::Max(max, hn::LoadU(d, values + i));
    largest = hn::GetLane(hn::MaxOfLanes(d, max));
  }
  for (; i < n; ++i) largest = values[i] > largest ? values[i] : largest;
  return largest;
}

AbsAndSquares SumAbsAndSquares(const float* HWY_RESTRICT values, std::size_t n) {
  AbsAndSquares out;
  std::size_t i = 0;
#if HWY_HAVE_FLOAT64
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> d_float;
  const std::size_t lanes = hn::Lanes(d);
  auto sum_abs = hn::Zero(d);
  auto sum_squares = hn::Zero(d);
  for (; i + lanes <= n; i += lanes) {
    const auto value = hn::PromoteTo(d, hn::LoadU(d_float, values + i));
    sum_abs = hn::Add(sum_abs, hn::Abs(value));
    sum_squares = hn::Add(sum_squares, hn::Mul(value, value));
  }
  out.sum_abs = hn::GetLane(hn::SumOfLanes(d, sum_abs));
  out.sum_squares = hn::GetLane(hn::SumOfLanes(d, sum_squares));
#endif
  for (; i < n; ++i) {
    const double value = values[i];
    out.sum_abs += value < 0.0 ? -value : value;
    out.sum_squares += value * value;
  }
  return out;
}

}  // namespace
}  // namespace lsv::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lsv::kernels {

HWY_EXPORT(Target);
HWY_EXPORT(RowSums8);
HWY_EXPORT(RowSums16);
HWY_EXPORT(Centre8);
HWY_EXPORT(Centre16);
HWY_EXPORT(AccumulateColumns);
HWY_EXPORT(Sum);
HWY_EXPORT(OverlapTerms);
HWY_EXPORT(Interleave);
HWY_EXPORT(Deinterleave);
HWY_EXPORT(UnpackPairSpectrum);
HWY_EXPORT(PackPairSpectrum);
HWY_EXPORT(MultiplyConj);
HWY_EXPORT(NormaliseOverlap);
HWY_EXPORT(MaxValue);
HWY_EXPORT(SumAbsAndSquares);

std::string_view simd_target() { return HWY_DYNAMIC_DISPATCH(Target)(); }

RowSums row_sums(const std::uint8_t* row, std::size_t n, std::uint8_t full_scale_counts) {
  return HWY_DYNAMIC_DISPATCH(RowSums8)(row, n, full_scale_counts);
}
RowSums row_sums(const std::uint16_t* row, std::size_t n, std::uint16_t full_scale_counts) {
  return HWY_DYNAMIC_DISPATCH(RowSums16)(row, n, full_scale_counts);
}
void centre(const std::uint8_t* row, std::size_t n, float mean_counts, float* out) {
  HWY_DYNAMIC_DISPATCH(Centre8)(row, n, mean_counts, out);
}
void centre(const std::uint16_t* row, std::size_t n, float mean_counts, float* out) {
  HWY_DYNAMIC_DISPATCH(Centre16)(row, n, mean_counts, out);
}
void accumulate_columns(const float* first_row, std::ptrdiff_t stride, std::size_t rows,
                        std::size_t n, double sign, double* sum, double* sum_sq) {
  HWY_DYNAMIC_DISPATCH(AccumulateColumns)(first_row, stride, rows, n, sign, sum, sum_sq);
}
double sum(const double* values, std::size_t n) { return HWY_DYNAMIC_DISPATCH(Sum)(values, n); }
void overlap_terms(const double* sums, const double* sum_sq, const double* inv_root_cols,
                   double inv_root_rows, double min_spread, std::size_t n, float* mean_root,
                   float* inv_norm) {
  HWY_DYNAMIC_DISPATCH(OverlapTerms)
  (sums, sum_sq, inv_root_cols, inv_root_rows, min_spread, n, mean_root, inv_norm);
}
void interleave(const float* re, const float* im, std::size_t n, std::complex<float>* out) {
  HWY_DYNAMIC_DISPATCH(Interleave)(re, im, n, out);
}
void deinterleave(const std::complex<float>* z, std::size_t n, float* re, float* im) {
  HWY_DYNAMIC_DISPATCH(Deinterleave)(z, n, re, im);
}
void unpack_pair_spectrum(const std::complex<float>* z, std::size_t n, std::ptrdiff_t stride,
                          std::complex<float>* out) {
  HWY_DYNAMIC_DISPATCH(UnpackPairSpectrum)(z, n, stride, out);
}
void pack_pair_spectrum(const std::complex<float>* in, std::ptrdiff_t stride, std::size_t n,
                        std::complex<float>* z) {
  HWY_DYNAMIC_DISPATCH(PackPairSpectrum)(in, stride, n, z);
}
void multiply_conj(const std::complex<float>* a, const std::complex<float>* b, std::size_t n,
                   std::complex<float>* out) {
  HWY_DYNAMIC_DISPATCH(MultiplyConj)(a, b, n, out);
}
void normalise_overlap(float* plane, std::size_t n, float scale, const float* mean_root_a,
                       const float* inv_norm_a, const float* mean_root_b, const float* inv_norm_b) {
  HWY_DYNAMIC_DISPATCH(NormaliseOverlap)
  (plane, n, scale, mean_root_a, inv_norm_a, mean_root_b, inv_norm_b);
}
float max_value(const float* values, std::size_t n) {
  return HWY_DYNAMIC_DISPATCH(MaxValue)(values, n);
}
AbsAndSquares sum_abs_and_squares(const float* values, std::size_t n) {
  return HWY_DYNAMIC_DISPATCH(SumAbsAndSquares)(values, n);
}

}  // namespace lsv::kernels
#endif  // HWY_ONCE
