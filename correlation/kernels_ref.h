// SPDX-License-Identifier: BSD-3-Clause
// The scalar truth of kernels.h: what each kernel means, written to be read. Used by tests only.
#pragma once

#include <algorithm>
#include <cmath>

#include "correlation/kernels.h"

namespace lsv::kernels::ref {

template <typename Pixel>
RowSums row_sums(const Pixel* row, std::size_t n, Pixel full_scale_counts) {
  RowSums out;
  for (std::size_t i = 0; i < n; ++i) {
    out.sum_counts += row[i];
    out.saturated += row[i] >= full_scale_counts ? 1 : 0;
  }
  return out;
}

template <typename Pixel>
void centre(const Pixel* row, std::size_t n, float mean_counts, float* out) {
  for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<float>(row[i]) - mean_counts;
}

inline void accumulate_columns(const float* first_row, std::ptrdiff_t stride, std::size_t rows,
                               std::size_t n, double sign, double* sum, double* sum_sq) {
  for (const float* row = first_row; rows > 0; --rows, row += stride) {
    for (std::size_t i = 0; i < n; ++i) {
      const double value = row[i];
      sum[i] += sign * value;
      sum_sq[i] += sign * (value * value);
    }
  }
}

inline double sum(const double* values, std::size_t n) {
  double out = 0.0;
  for (std::size_t i = 0; i < n; ++i) out += values[i];
  return out;
}

inline void overlap_terms(const double* sum, const double* sum_sq, const double* inv_root_cols,
                          double inv_root_rows, double min_spread, std::size_t n, float* mean_root,
                          float* inv_norm) {
  for (std::size_t i = 0; i < n; ++i) {
    const double root = sum[i] * (inv_root_cols[i] * inv_root_rows);
    const auto spread = static_cast<float>(sum_sq[i] - root * root);
    mean_root[i] = static_cast<float>(root);
    inv_norm[i] = spread > static_cast<float>(min_spread) ? 1.0F / std::sqrt(spread) : 0.0F;
  }
}

inline void interleave(const float* re, const float* im, std::size_t n, std::complex<float>* out) {
  for (std::size_t i = 0; i < n; ++i) out[i] = {re[i], im[i]};
}

inline void deinterleave(const std::complex<float>* z, std::size_t n, float* re, float* im) {
  for (std::size_t i = 0; i < n; ++i) {
    re[i] = z[i].real();
    im[i] = z[i].imag();
  }
}

inline void unpack_pair_spectrum(const std::complex<float>* z, std::size_t n, std::ptrdiff_t stride,
                                 std::complex<float>* out) {
  for (std::size_t k = 0; k <= n / 2; ++k, out += stride) {
    const std::complex<float> mirrored = std::conj(z[(n - k) % n]);
    const std::complex<float> difference = z[k] - mirrored;
    out[0] = 0.5F * (z[k] + mirrored);
    out[1] = {0.5F * difference.imag(), -0.5F * difference.real()};
  }
}

inline void pack_pair_spectrum(const std::complex<float>* in, std::ptrdiff_t stride, std::size_t n,
                               std::complex<float>* z) {
  for (std::size_t k = 0; k <= n / 2; ++k, in += stride) {
    const std::complex<float> i_b(-in[1].imag(), in[1].real());
    z[(n - k) % n] = std::conj(in[0] - i_b);
    z[k] = in[0] + i_b;
  }
}

inline void multiply_conj(const std::complex<float>* a, const std::complex<float>* b, std::size_t n,
                          std::complex<float>* out) {
  for (std::size_t i = 0; i < n; ++i) {
    const float re = a[i].real() * b[i].real() + a[i].imag() * b[i].imag();
    const float im = a[i].real() * b[i].imag() - a[i].imag() * b[i].real();
    out[i] = {re, im};
  }
}

inline void normalise_overlap(float* plane, std::size_t n, float scale, const float* mean_root_a,
                              const float* inv_norm_a, const float* mean_root_b,
                              const float* inv_norm_b) {
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t r = n - 1 - i;
    const float product = scale * plane[i] - mean_root_a[r] * mean_root_b[i];
    plane[i] = product * (inv_norm_a[r] * inv_norm_b[i]);
  }
}

inline float max_value(const float* values, std::size_t n) {
  return *std::max_element(values, values + n);
}

inline AbsAndSquares sum_abs_and_squares(const float* values, std::size_t n) {
  AbsAndSquares out;
  for (std::size_t i = 0; i < n; ++i) {
    const double value = values[i];
    out.sum_abs += std::abs(value);
    out.sum_squares += value * value;
  }
  return out;
}

}  // namespace lsv::kernels::ref
