// SPDX-License-Identifier: BSD-3-Clause
// ZNCC by its definition: no FFT, no shared sums. The oracle of the other engines.
#include <vector>

#include "correlation/engines.h"

namespace lsv {
namespace {

class DirectCorrelator final : public Correlator {
 public:
  DirectCorrelator(const FrameFormat& format, const LagRange& lags)
      : Correlator(format, lags),
        column_sums_(static_cast<std::size_t>(format.width_px)),
        column_squares_(static_cast<std::size_t>(format.width_px)) {}

  PreparedFrame make_prepared_frame() const override {
    PreparedFrame out;
    out.format = format();
    out.stride_px = format().width_px;
    out.centred = AlignedBuffer<float>(static_cast<std::size_t>(format().width_px) *
                                       static_cast<std::size_t>(format().height_px));
    return out;
  }

  void prepare(const FrameView& frame, PreparedFrame& out) override {
    centre_frame(frame, out, column_sums_.span(), column_squares_.span());
  }

  void correlate(const PreparedFrame& earlier, const PreparedFrame& later,
                 CorrelationPlane& plane) override {
    std::size_t i = 0;
    for (int dy = -lags().max_dy_px; dy <= lags().max_dy_px; ++dy) {
      for (int dx = -lags().max_dx_px; dx <= lags().max_dx_px; ++dx)
        plane.values[i++] = static_cast<float>(zncc_at(earlier, later, dx, dy));
    }
  }

 private:
  AlignedBuffer<double> column_sums_;
  AlignedBuffer<double> column_squares_;
};

}  // namespace

std::unique_ptr<Correlator> make_direct_correlator(const FrameFormat& format,
                                                   const LagRange& lags) {
  return std::make_unique<DirectCorrelator>(format, lags);
}

}  // namespace lsv
