// SPDX-License-Identifier: BSD-3-Clause
// The one file that knows kissfft (BSD-3-Clause), the permissive back end.
#include <kiss_fft.h>
#include <kiss_fftr.h>

#include <algorithm>

#include "correlation/aligned_buffer.h"
#include "correlation/fft.h"

namespace lsv {
namespace {

struct FreeKiss {
  template <typename T>
  void operator()(T* p) const {
    kiss_fft_free(p);
  }
};
using ComplexPlan = std::unique_ptr<std::remove_pointer_t<kiss_fft_cfg>, FreeKiss>;
using RealPlan = std::unique_ptr<std::remove_pointer_t<kiss_fftr_cfg>, FreeKiss>;

kiss_fft_cpx* raw(std::complex<float>* p) { return reinterpret_cast<kiss_fft_cpx*>(p); }
const kiss_fft_cpx* raw(const std::complex<float>* p) {
  return reinterpret_cast<const kiss_fft_cpx*>(p);
}

class KissRealFft2d final : public RealFft2d {
 public:
  explicit KissRealFft2d(const FftShape& shape)
      : RealFft2d(shape),
        half_(shape.cols / 2 + 1),
        rows_of_halves_(spectrum_size()),
        column_(static_cast<std::size_t>(shape.rows)),
        row_forward_(kiss_fftr_alloc(shape.cols, 0, nullptr, nullptr)),
        row_inverse_(kiss_fftr_alloc(shape.cols, 1, nullptr, nullptr)),
        col_forward_(kiss_fft_alloc(shape.rows, 0, nullptr, nullptr)),
        col_inverse_(kiss_fft_alloc(shape.rows, 1, nullptr, nullptr)) {}

  void forward(const float* image, std::complex<float>* spectrum) override {
    for (std::ptrdiff_t y = 0; y < shape_.input_rows; ++y) {
      kiss_fftr(row_forward_.get(), image + y * shape_.cols,
                raw(rows_of_halves_.data() + y * half_));
    }
    std::fill(rows_of_halves_.data() + shape_.input_rows * half_,
              rows_of_halves_.data() + rows_of_halves_.size(), std::complex<float>{});
    for (std::ptrdiff_t x = 0; x < half_; ++x) {
      kiss_fft_stride(col_forward_.get(), raw(rows_of_halves_.data() + x),
                      raw(spectrum + x * shape_.rows), static_cast<int>(half_));
    }
  }

  void inverse(const std::complex<float>* spectrum, float* image) override {
    for (std::ptrdiff_t x = 0; x < half_; ++x) {
      kiss_fft(col_inverse_.get(), raw(spectrum + x * shape_.rows), raw(column_.data()));
      for (std::ptrdiff_t y = 0; y < shape_.rows; ++y) {
        rows_of_halves_[static_cast<std::size_t>(y * half_ + x)] =
            column_[static_cast<std::size_t>(y)];
      }
    }
    for (std::ptrdiff_t y = 0; y < shape_.rows; ++y) {
      if (y > shape_.output_edge_rows && y < shape_.rows - shape_.output_edge_rows) continue;
      kiss_fftri(row_inverse_.get(), raw(rows_of_halves_.data() + y * half_),
                 image + y * shape_.cols);
    }
  }

 private:
  std::ptrdiff_t half_;
  AlignedBuffer<std::complex<float>> rows_of_halves_;
  AlignedBuffer<std::complex<float>> column_;
  RealPlan row_forward_;
  RealPlan row_inverse_;
  ComplexPlan col_forward_;
  ComplexPlan col_inverse_;
};

}  // namespace

std::unique_ptr<RealFft2d> make_real_fft2d(const FftShape& shape) {
  return std::make_unique<KissRealFft2d>(shape);
}

std::string_view fft_backend() { return "kissfft"; }

}  // namespace lsv
