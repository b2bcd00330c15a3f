// SPDX-License-Identifier: BSD-3-Clause
// The SIMD kernels of the hot path. Plain functions that pick the best instruction set of this
// machine at run time (Google Highway); kernels_ref.h holds the scalar truth they are tested
// against on every target. Element-wise kernels give equal bits on every target (no fused
// multiply-add); sums may differ in the last bits of a double. No allocation, no alignment
// needed, any length.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lsv::kernels {

/// The instruction set in force, e.g. "AVX3" or "SCALAR".
std::string_view simd_target();

struct RowSums {
  std::uint64_t sum_counts = 0;
  std::uint64_t saturated = 0;  // pixels >= full_scale_counts
};

RowSums row_sums(const std::uint8_t* row, std::size_t n, std::uint8_t full_scale_counts);
RowSums row_sums(const std::uint16_t* row, std::size_t n, std::uint16_t full_scale_counts);

/// out[i] = row[i] - mean
void centre(const std::uint8_t* row, std::size_t n, float mean_counts, float* out);
void centre(const std::uint16_t* row, std::size_t n, float mean_counts, float* out);

/// For each of `rows` rows of n values, `stride` values apart, in that order:
/// sum[i] += sign * row[i], sum_sq[i] += sign * row[i]^2; sign is +1 or -1.
void accumulate_columns(const float* first_row, std::ptrdiff_t stride, std::size_t rows,
                        std::size_t n, double sign, double* sum, double* sum_sq);

double sum(const double* values, std::size_t n);

/// Turns the pixel sums of n overlap regions into their ZNCC terms (see OverlapTables):
/// root = sum[i] * inv_root_cols[i] * inv_root_rows; mean_root[i] = root;
/// spread = sum_sq[i] - root^2, rounded to single precision; inv_norm[i] = 1 / sqrt(spread), or 0
/// unless spread > min_spread.
void overlap_terms(const double* sum, const double* sum_sq, const double* inv_root_cols,
                   double inv_root_rows, double min_spread, std::size_t n, float* mean_root,
                   float* inv_norm);

/// out[i] = re[i] + i im[i]
void interleave(const float* re, const float* im, std::size_t n, std::complex<float>* out);

/// re[i] and im[i] are the parts of z[i].
void deinterleave(const std::complex<float>* z, std::size_t n, float* re, float* im);

/// Two real rows a and b of even length n make the complex row a + i b. With `z` its spectrum, and
/// A and B those of a and b: out[k * stride] = A[k], out[k * stride + 1] = B[k], 0 <= k <= n / 2.
void unpack_pair_spectrum(const std::complex<float>* z, std::size_t n, std::ptrdiff_t stride,
                          std::complex<float>* out);

/// The way back: z[k] of all n from in[k * stride] = A[k] and in[k * stride + 1] = B[k].
void pack_pair_spectrum(const std::complex<float>* in, std::ptrdiff_t stride, std::size_t n,
                        std::complex<float>* z);

/// out[i] = conj(a[i]) * b[i]; out may be a or b.
void multiply_conj(const std::complex<float>* a, const std::complex<float>* b, std::size_t n,
                   std::complex<float>* out);

/// The ZNCC of every lag from its raw correlation sum (see prepared_frame.h for mean_root and
/// inv_norm): plane[i] = (scale * plane[i] - mean_root_a[n-1-i] * mean_root_b[i])
///                       * inv_norm_a[n-1-i] * inv_norm_b[i].
/// The earlier frame's tables run backwards: its overlap at lag d is the later one's at -d.
void normalise_overlap(float* plane, std::size_t n, float scale, const float* mean_root_a,
                       const float* inv_norm_a, const float* mean_root_b, const float* inv_norm_b);

/// Largest value; n >= 1.
float max_value(const float* values, std::size_t n);

struct AbsAndSquares {
  double sum_abs = 0.0;
  double sum_squares = 0.0;
};
AbsAndSquares sum_abs_and_squares(const float* values, std::size_t n);

}  // namespace lsv::kernels
