// SPDX-License-Identifier: BSD-3-Clause
// Correlation of real images through the FFT, single precision. Images are padded with zeros by
// the search range, so no lag that is read out wraps around. Two real rows make one complex row,
// both ways; a spectrum holds its columns one after the other. Plans are made once,
// deterministically (never by timing), so equal input gives equal bits on every run. Back end: FFTW
// or kissfft, chosen at configure time (LSV_FFT); each is known to one file.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <string_view>

#include "correlation/aligned_buffer.h"

namespace lsv {

enum class FftDirection { forward, inverse };

/// A complex transform of one length, unnormalised: what a back end provides. One object per
/// thread. Calls do not allocate.
class ComplexFft {
 public:
  virtual ~ComplexFft() = default;

  /// `in` and `out` do not overlap and stand on 64-byte boundaries.
  virtual void run(const std::complex<float>* in, std::complex<float>* out) = 0;
};

std::unique_ptr<ComplexFft> make_complex_fft(int length, FftDirection direction);

/// "fftw" or "kissfft".
std::string_view fft_backend();

/// The smallest length >= `at_least` of 4, 8, 16, ... times 1, 3 or 5 (FFTW is slow at others).
int fast_fft_length(int at_least);

/// out[i] = product of earlier[i] and later[i], n values; the arrays do not overlap.
using SpectrumProduct = void (*)(const std::complex<float>* earlier,
                                 const std::complex<float>* later, std::size_t n,
                                 std::complex<float>* out);

struct CorrelationSize {
  int width = 0;  // of the images
  int height = 0;
  int max_dx = 0;  // lags that are wanted: -max_dx..max_dx, -max_dy..max_dy
  int max_dy = 0;
};

/// One object per thread: it owns scratch memory. Calls do not allocate.
class SpectralCorrelation {
 public:
  explicit SpectralCorrelation(const CorrelationSize& size);

  std::size_t spectrum_size() const;

  /// `image`: height rows of width values, `stride` values apart. `spectrum`: spectrum_size()
  /// values on a 64-byte boundary.
  void forward(const float* image, std::ptrdiff_t stride, std::complex<float>* spectrum);

  /// With multiply_conj as `product`: plane(dx, dy) = scale() * sum of
  /// earlier(x, y) * later(x + dx, y + dy). 2 max_dy + 1 rows of 2 max_dx + 1 values, dense.
  void correlate(const std::complex<float>* earlier, const std::complex<float>* later,
                 SpectrumProduct product, float* plane);

  float scale() const { return static_cast<float>(rows_) * static_cast<float>(cols_); }

 private:
  std::ptrdiff_t columns() const { return cols_ / 2 + 1; }  // of a real image's spectrum
  void read_row_pair(std::ptrdiff_t dy, float* plane);

  CorrelationSize size_;
  std::ptrdiff_t rows_, cols_;  // lengths of the transforms
  std::ptrdiff_t col_stride_;
  std::unique_ptr<ComplexFft> row_forward_, row_inverse_, col_forward_, col_inverse_;
  AlignedBuffer<std::complex<float>> row_spectra_;  // by columns, like a spectrum
  AlignedBuffer<std::complex<float>> padded_pair_;  // zero from `width` on
  AlignedBuffer<std::complex<float>> pair_spectrum_;
  AlignedBuffer<std::complex<float>> lag_pair_;
  AlignedBuffer<std::complex<float>> product_;
  AlignedBuffer<float> zero_row_;
  AlignedBuffer<float> unwanted_row_;
};

}  // namespace lsv
