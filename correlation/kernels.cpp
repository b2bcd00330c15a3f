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

void AccumulateColumns(const float* HWY_RESTRICT row, std::size_t n, double sign,
                       double* HWY_RESTRICT sum, double* HWY_RESTRICT sum_sq) {
  std::size_t i = 0;
#if HWY_HAVE_FLOAT64
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> d_float;
  const std::size_t lanes = hn::Lanes(d);
  const auto signs = hn::Set(d, sign);
  for (; i + lanes <= n; i += lanes) {
    const auto value = hn::PromoteTo(d, hn::LoadU(d_float, row + i));
    hn::StoreU(hn::Add(hn::LoadU(d, sum + i), hn::Mul(signs, value)), d, sum + i);
    const auto square = hn::Mul(value, value);
    hn::StoreU(hn::Add(hn::LoadU(d, sum_sq + i), hn::Mul(signs, square)), d, sum_sq + i);
  }
#endif
  for (; i < n; ++i) {
    const double value = row[i];
    sum[i] += sign * value;
    sum_sq[i] += sign * (value * value);
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
  const auto least = hn::Set(d, min_spread);
  const auto one = hn::Set(d, 1.0);
  for (; i + lanes <= n; i += lanes) {
    const auto root =
        hn::Mul(hn::LoadU(d, sum + i), hn::Mul(hn::LoadU(d, inv_root_cols + i), rows));
    const auto spread = hn::Sub(hn::LoadU(d, sum_sq + i), hn::Mul(root, root));
    const auto has_pattern = hn::Gt(spread, least);
    // Lanes without a pattern take the root of 1, not of a rounded-off negative.
    const auto norm = hn::Div(one, hn::Sqrt(hn::IfThenElse(has_pattern, spread, one)));
    hn::StoreU(hn::DemoteTo(d_float, root), d_float, mean_root + i);
    hn::StoreU(hn::DemoteTo(d_float, hn::IfThenElseZero(has_pattern, norm)), d_float, inv_norm + i);
  }
#endif
  for (; i < n; ++i) {
    const double root = sum[i] * (inv_root_cols[i] * inv_root_rows);
    const double spread = sum_sq[i] - root * root;
    mean_root[i] = static_cast<float>(root);
    inv_norm[i] = spread > min_spread ? static_cast<float>(1.0 / std::sqrt(spread)) : 0.0F;
  }
}

template <class D>
HWY_INLINE void ConjTimes(D d, const hn::Vec<D>& a_re, const hn::Vec<D>& a_im, hn::Vec<D>& b_re,
                          hn::Vec<D>& b_im) {
  (void)d;
  const auto re = hn::Add(hn::Mul(a_re, b_re), hn::Mul(a_im, b_im));
  b_im = hn::Sub(hn::Mul(a_re, b_im), hn::Mul(a_im, b_re));
  b_re = re;
}

void MultiplyConj(const std::complex<float>* a, const std::complex<float>* b, std::size_t n,
                  std::complex<float>* out) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  const float* pa = reinterpret_cast<const float*>(a);
  const float* pb = reinterpret_cast<const float*>(b);
  float* po = reinterpret_cast<float*>(out);
  for (; i + lanes <= n; i += lanes) {
    hn::Vec<decltype(d)> a_re, a_im, b_re, b_im;
    hn::LoadInterleaved2(d, pa + 2 * i, a_re, a_im);
    hn::LoadInterleaved2(d, pb + 2 * i, b_re, b_im);
    ConjTimes(d, a_re, a_im, b_re, b_im);
    hn::StoreInterleaved2(b_re, b_im, d, po + 2 * i);
  }
#endif
  // One-lane vectors, not plain floats: where the target has FMA, g++ 12 fuses the plain
  // expression in spite of -ffp-contract=off and the tail would differ from the body.
  const hn::CappedTag<float, 1> d1;
  for (; i < n; ++i) {
    auto b_re = hn::Set(d1, b[i].real());
    auto b_im = hn::Set(d1, b[i].imag());
    ConjTimes(d1, hn::Set(d1, a[i].real()), hn::Set(d1, a[i].imag()), b_re, b_im);
    out[i] = {hn::GetLane(b_re), hn::GetLane(b_im)};
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
void accumulate_columns(const float* row, std::size_t n, double sign, double* sum, double* sum_sq) {
  HWY_DYNAMIC_DISPATCH(AccumulateColumns)(row, n, sign, sum, sum_sq);
}
double sum(const double* values, std::size_t n) { return HWY_DYNAMIC_DISPATCH(Sum)(values, n); }
void overlap_terms(const double* sums, const double* sum_sq, const double* inv_root_cols,
                   double inv_root_rows, double min_spread, std::size_t n, float* mean_root,
                   float* inv_norm) {
  HWY_DYNAMIC_DISPATCH(OverlapTerms)
  (sums, sum_sq, inv_root_cols, inv_root_rows, min_spread, n, mean_root, inv_norm);
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
