// SPDX-License-Identifier: BSD-3-Clause
// The one file that knows FFTW (GPL-2+).
#include <fftw3.h>

#include <mutex>

#include "correlation/aligned_buffer.h"
#include "correlation/fft.h"

namespace lsv {
namespace {

std::mutex& planner_mutex() {  // FFTW's planner is not thread-safe; executing plans is
  static std::mutex mutex;
  return mutex;
}

struct DestroyPlan {
  void operator()(fftwf_plan plan) const {
    const std::lock_guard lock(planner_mutex());
    fftwf_destroy_plan(plan);
  }
};
using Plan = std::unique_ptr<std::remove_pointer_t<fftwf_plan>, DestroyPlan>;

fftwf_complex* raw(std::complex<float>* p) { return reinterpret_cast<fftwf_complex*>(p); }

class FftwRealFft2d final : public RealFft2d {
 public:
  explicit FftwRealFft2d(const FftShape& shape)
      : RealFft2d(shape),
        half_stride_((shape.cols / 2 + 1 + 7) / 8 * 8),
        rows_of_halves_(static_cast<std::size_t>(shape.rows * half_stride_)) {
    AlignedBuffer<float> image(image_size());
    AlignedBuffer<std::complex<float>> spectrum(spectrum_size());
    const int half = shape.cols / 2 + 1;
    // ESTIMATE: a plan picked by timing would differ from run to run in the last bits.
    constexpr unsigned kFlags = FFTW_ESTIMATE | FFTW_PRESERVE_INPUT;
    constexpr unsigned kFlagsInverse = FFTW_ESTIMATE | FFTW_DESTROY_INPUT;
    fftwf_complex* const scratch = raw(rows_of_halves_.data());
    const std::lock_guard lock(planner_mutex());
    row_forward_.reset(fftwf_plan_many_dft_r2c(1, &shape_.cols, shape.input_rows, image.data(),
                                               nullptr, 1, shape.cols, scratch, nullptr, 1,
                                               half_stride_, kFlags));
    col_forward_.reset(fftwf_plan_many_dft(1, &shape_.rows, half, scratch, nullptr, half_stride_, 1,
                                           raw(spectrum.data()), nullptr, 1, shape.rows,
                                           FFTW_FORWARD, kFlags));
    col_inverse_.reset(fftwf_plan_many_dft(1, &shape_.rows, half, raw(spectrum.data()), nullptr, 1,
                                           shape.rows, scratch, nullptr, half_stride_, 1,
                                           FFTW_BACKWARD, kFlags));
    top_rows_inverse_.reset(fftwf_plan_many_dft_c2r(1, &shape_.cols, shape.output_edge_rows + 1,
                                                    scratch, nullptr, 1, half_stride_, image.data(),
                                                    nullptr, 1, shape.cols, kFlagsInverse));
    if (shape.output_edge_rows > 0) {
      bottom_rows_inverse_.reset(fftwf_plan_many_dft_c2r(
          1, &shape_.cols, shape.output_edge_rows, scratch, nullptr, 1, half_stride_, image.data(),
          nullptr, 1, shape.cols, kFlagsInverse));
    }
  }

  void forward(const float* image, std::complex<float>* spectrum) override {
    fftwf_execute_dft_r2c(row_forward_.get(), const_cast<float*>(image),
                          raw(rows_of_halves_.data()));
    // The inverse leaves its intermediate rows behind: those that forward() relies on being zero
    // are cleared again.
    std::fill(rows_of_halves_.data() + shape_.input_rows * half_stride_,
              rows_of_halves_.data() + rows_of_halves_.size(), std::complex<float>{});
    fftwf_execute_dft(col_forward_.get(), raw(rows_of_halves_.data()), raw(spectrum));
  }

  void inverse(const std::complex<float>* spectrum, float* image) override {
    fftwf_complex* const scratch = raw(rows_of_halves_.data());
    fftwf_execute_dft(col_inverse_.get(), raw(const_cast<std::complex<float>*>(spectrum)), scratch);
    fftwf_execute_dft_c2r(top_rows_inverse_.get(), scratch, image);
    if (bottom_rows_inverse_) {
      const std::ptrdiff_t first = shape_.rows - shape_.output_edge_rows;
      fftwf_execute_dft_c2r(bottom_rows_inverse_.get(), scratch + first * half_stride_,
                            image + first * shape_.cols);
    }
  }

 private:
  int half_stride_;  // rows of halves start on 64-byte boundaries
  AlignedBuffer<std::complex<float>> rows_of_halves_;
  Plan row_forward_;
  Plan col_forward_;
  Plan col_inverse_;
  Plan top_rows_inverse_;
  Plan bottom_rows_inverse_;
};

}  // namespace

std::unique_ptr<RealFft2d> make_real_fft2d(const FftShape& shape) {
  return std::make_unique<FftwRealFft2d>(shape);
}

std::string_view fft_backend() { return "fftw"; }

}  // namespace lsv
