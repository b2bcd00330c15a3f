// SPDX-License-Identifier: BSD-3-Clause
// Real two-dimensional FFT, single precision, unnormalised, for correlating zero-padded frames.
// Rows known to be zero on the way in, and rows nobody reads on the way out, are skipped. The
// spectrum is an opaque array: its layout (column-major half spectrum) serves only element-wise
// products. Plans are made once, deterministically (never by timing), so equal input gives equal
// bits on every run. Back end: FFTW or kissfft, chosen at configure time (LSV_FFT); each is known
// to one file.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <string_view>

namespace lsv {

struct FftShape {
  int rows = 0;
  int cols = 0;              // even
  int input_rows = 0;        // rows [0, input_rows) of the image may be non-zero
  int output_edge_rows = 0;  // rows [0, k] and [rows - k, rows) of the result are wanted
};

/// One object per thread: it owns scratch memory. Calls do not allocate.
class RealFft2d {
 public:
  explicit RealFft2d(const FftShape& shape) : shape_(shape) {}
  virtual ~RealFft2d() = default;

  const FftShape& shape() const { return shape_; }
  std::size_t image_size() const {
    return static_cast<std::size_t>(shape_.rows) * static_cast<std::size_t>(shape_.cols);
  }
  std::size_t spectrum_size() const {
    return static_cast<std::size_t>(shape_.rows) * static_cast<std::size_t>(shape_.cols / 2 + 1);
  }

  /// `image`: rows x cols, dense, 64-byte aligned. Rows from input_rows on are taken as zero.
  virtual void forward(const float* image, std::complex<float>* spectrum) = 0;
  /// Unnormalised: forward then inverse multiplies by rows * cols. Only the wanted rows of
  /// `image` are written. `spectrum` is left as it was.
  virtual void inverse(const std::complex<float>* spectrum, float* image) = 0;

 protected:
  FftShape shape_;
};

std::unique_ptr<RealFft2d> make_real_fft2d(const FftShape& shape);

/// "fftw" or "kissfft".
std::string_view fft_backend();

/// The smallest length >= `at_least` that both back ends transform fast: 4 * 2^a 3^b 5^c.
int fast_fft_length(int at_least);

}  // namespace lsv
