// SPDX-License-Identifier: BSD-3-Clause
// The one file that knows FFTW (GPL-2+).
#include <fftw3.h>

#include <mutex>

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

Plan make_plan(int length, FftDirection direction) {
  // Any addresses on the same boundary will do: ESTIMATE does not touch them. It is also the only
  // deterministic choice; a plan picked by timing would differ from run to run in the last bits.
  AlignedBuffer<std::complex<float>> in(static_cast<std::size_t>(length));
  AlignedBuffer<std::complex<float>> out(static_cast<std::size_t>(length));
  const std::lock_guard lock(planner_mutex());
  return Plan(fftwf_plan_dft_1d(length, raw(in.data()), raw(out.data()),
                                direction == FftDirection::forward ? FFTW_FORWARD : FFTW_BACKWARD,
                                FFTW_ESTIMATE | FFTW_PRESERVE_INPUT));
}

class FftwComplexFft final : public ComplexFft {
 public:
  FftwComplexFft(int length, FftDirection direction) : plan_(make_plan(length, direction)) {}

  void run(const std::complex<float>* in, std::complex<float>* out) override {
    fftwf_execute_dft(plan_.get(), raw(const_cast<std::complex<float>*>(in)), raw(out));
  }

 private:
  Plan plan_;
};

}  // namespace

std::unique_ptr<ComplexFft> make_complex_fft(int length, FftDirection direction) {
  return std::make_unique<FftwComplexFft>(length, direction);
}

std::string_view fft_backend() { return "fftw"; }

}  // namespace lsv
