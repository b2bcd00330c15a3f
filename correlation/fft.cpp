// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/fft.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "correlation/kernels.h"

namespace lsv {
namespace {

/// Room for `length` values in an odd number of cache lines, so that neighbours in the other
/// direction spread over all sets of the cache.
std::ptrdiff_t odd_lines(std::ptrdiff_t length) {
  constexpr std::ptrdiff_t kPerLine = 64 / sizeof(std::complex<float>);
  return ((length + kPerLine - 1) / kPerLine | 1) * kPerLine;
}

AlignedBuffer<std::complex<float>> buffer(std::ptrdiff_t size) {
  return AlignedBuffer<std::complex<float>>(static_cast<std::size_t>(size));
}

}  // namespace

int fast_fft_length(int at_least) {
  int shortest = std::numeric_limits<int>::max();
  for (int length : {4, 12, 20}) {
    while (length < at_least) length *= 2;
    shortest = std::min(shortest, length);
  }
  return shortest;
}

SpectralCorrelation::SpectralCorrelation(const CorrelationSize& size)
    : size_(size),
      rows_(fast_fft_length(size.height + size.max_dy)),
      cols_(fast_fft_length(size.width + size.max_dx)),
      col_stride_(odd_lines(rows_)),
      row_forward_(make_complex_fft(static_cast<int>(cols_), FftDirection::forward)),
      row_inverse_(make_complex_fft(static_cast<int>(cols_), FftDirection::inverse)),
      col_forward_(make_complex_fft(static_cast<int>(rows_), FftDirection::forward)),
      col_inverse_(make_complex_fft(static_cast<int>(rows_), FftDirection::inverse)),
      row_spectra_(buffer(columns() * col_stride_)),
      padded_pair_(buffer(cols_)),
      pair_spectrum_(buffer(cols_)),
      lag_pair_(buffer(cols_)),
      product_(buffer(rows_)),
      zero_row_(static_cast<std::size_t>(size.width)),
      unwanted_row_(static_cast<std::size_t>(2 * size.max_dx + 1)) {}

std::size_t SpectralCorrelation::spectrum_size() const { return row_spectra_.size(); }

void SpectralCorrelation::forward(const float* image, std::ptrdiff_t stride,
                                  std::complex<float>* spectrum) {
  for (std::ptrdiff_t y = 0; y < size_.height; y += 2) {
    const float* const row = image + y * stride;
    kernels::interleave(row, y + 1 < size_.height ? row + stride : zero_row_.data(),
                        zero_row_.size(), padded_pair_.data());
    row_forward_->run(padded_pair_.data(), pair_spectrum_.data());
    kernels::unpack_pair_spectrum(pair_spectrum_.data(), pair_spectrum_.size(), col_stride_,
                                  row_spectra_.data() + y);
  }
  // correlate() leaves its own rows behind; below the image they are zero.
  const std::ptrdiff_t end = (size_.height + 1) / 2 * 2;
  for (std::ptrdiff_t at = 0; at < columns() * col_stride_; at += col_stride_) {
    std::complex<float>* const column = row_spectra_.data() + at;
    std::fill(column + end, column + rows_, std::complex<float>{});
    col_forward_->run(column, spectrum + at);
  }
}

void SpectralCorrelation::correlate(const std::complex<float>* earlier,
                                    const std::complex<float>* later, SpectrumProduct product,
                                    float* plane) {
  for (std::ptrdiff_t at = 0; at < columns() * col_stride_; at += col_stride_) {
    product(earlier + at, later + at, product_.size(), product_.data());
    col_inverse_->run(product_.data(), row_spectra_.data() + at);
  }
  // Pairs begin at even rows: the wrap-around between -1 and 0 must not tear one apart.
  const int first_dy = -((size_.max_dy + 1) / 2 * 2);
  for (int dy = first_dy; dy <= size_.max_dy; dy += 2) read_row_pair(dy, plane);
}

/// Lags (., dy) and (., dy + 1), those of them that are wanted. Negative lags stand at the far end.
void SpectralCorrelation::read_row_pair(std::ptrdiff_t dy, float* plane) {
  kernels::pack_pair_spectrum(row_spectra_.data() + (dy < 0 ? rows_ + dy : dy), col_stride_,
                              pair_spectrum_.size(), pair_spectrum_.data());
  row_inverse_->run(pair_spectrum_.data(), lag_pair_.data());
  const std::ptrdiff_t max_dx = size_.max_dx;
  const std::ptrdiff_t max_dy = size_.max_dy;
  const auto plane_row = [&](std::ptrdiff_t row_dy) {
    return std::abs(row_dy) <= max_dy ? plane + (row_dy + max_dy) * (2 * max_dx + 1)
                                      : unwanted_row_.data();
  };
  float* const first = plane_row(dy);
  float* const second = plane_row(dy + 1);
  kernels::deinterleave(lag_pair_.data() + cols_ - max_dx, static_cast<std::size_t>(max_dx), first,
                        second);
  kernels::deinterleave(lag_pair_.data(), static_cast<std::size_t>(max_dx + 1), first + max_dx,
                        second + max_dx);
}

}  // namespace lsv
