// SPDX-License-Identifier: BSD-3-Clause
// The one file that knows kissfft (BSD-3-Clause), the permissive back end.
#include <kiss_fft.h>

#include "correlation/fft.h"

namespace lsv {
namespace {

struct FreeKiss {
  void operator()(kiss_fft_cfg plan) const { kiss_fft_free(plan); }
};
using Plan = std::unique_ptr<std::remove_pointer_t<kiss_fft_cfg>, FreeKiss>;

class KissComplexFft final : public ComplexFft {
 public:
  KissComplexFft(int length, FftDirection direction)
      : plan_(kiss_fft_alloc(length, direction == FftDirection::inverse, nullptr, nullptr)) {}

  void run(const std::complex<float>* in, std::complex<float>* out) override {
    kiss_fft(plan_.get(), reinterpret_cast<const kiss_fft_cpx*>(in),
             reinterpret_cast<kiss_fft_cpx*>(out));
  }

 private:
  Plan plan_;
};

}  // namespace

std::unique_ptr<ComplexFft> make_complex_fft(int length, FftDirection direction) {
  return std::make_unique<KissComplexFft>(length, direction);
}

std::string_view fft_backend() { return "kissfft"; }

}  // namespace lsv
