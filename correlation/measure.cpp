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

Shift measure_shift(Correlator& correlator, Engine engine, const NoiseModel& noise,
                    const PreparedFrame& earlier, const PreparedFrame& later,
                    CorrelationPlane& plane) {
  correlator.correlate(earlier, later, plane);
  const Peak peak = find_peak(plane, noise.fit);
  Shift out;
  out.quality = measure_quality(plane, peak);
  if (engine == Engine::cross || engine == Engine::phase)
    out.quality.zncc = zncc_at(earlier, later, peak.lag_dx_px, peak.lag_dy_px);
  out.status = peak.status;
  if (out.status != ShiftStatus::ok) return out;
  out.dx_px = peak.dx_px;
  out.dy_px = peak.dy_px;
  out.cov = shift_covariance(peak, out.quality.zncc, earlier.stats, later.stats,
                             overlap_px(correlator.format(), peak), noise);
  return out;
}

}  // namespace lsv
