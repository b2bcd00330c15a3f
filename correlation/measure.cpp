// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/measure.h"

#include <cmath>
#include <cstdlib>

namespace lsv {
namespace {

double overlap_px(const FrameFormat& format, const Peak& peak) {
  return static_cast<double>(format.width_px - std::abs(peak.lag_dx_px)) *
         (format.height_px - std::abs(peak.lag_dy_px));
}

}  // namespace

Shift measure_shift(Correlator& correlator, PeakFit fit, const ErrorModel& model,
                    const PreparedFrame& earlier, const PreparedFrame& later,
                    CorrelationPlane& plane) {
  correlator.correlate(earlier, later, plane);
  const Peak peak = find_peak(plane, fit);
  const double overlap = overlap_px(correlator.format(), peak);
  std::optional<double> zncc;
  if (model.engine == Engine::cross || model.engine == Engine::phase)
    zncc = zncc_at(earlier, later, peak.lag_dx_px, peak.lag_dy_px);
  Shift out;
  out.quality = measure_quality(plane, peak, overlap, zncc);
  out.status = peak.status;
  if (out.status != ShiftStatus::ok) return out;
  out.dx_px = peak.dx_px;
  out.dy_px = peak.dy_px;
  const ShiftError error =
      shift_error(peak, out.quality.zncc, earlier.stats, later.stats, overlap, model);
  out.cov = error.cov;
  out.model_sigma_x_px = error.model_sigma_x_px;
  out.model_sigma_y_px = error.model_sigma_y_px;
  return out;
}

}  // namespace lsv
