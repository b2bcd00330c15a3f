// SPDX-License-Identifier: BSD-3-Clause
#include "bench/answers.h"

#include <cmath>
#include <cstdio>

#include "correlation/peak.h"

namespace lsv::bench {

std::string wrong(const Answer& answer, const cli::TrueShift& truth, double tolerance_px) {
  if (std::abs(answer.dx_px - truth.dx_px) <= tolerance_px &&
      std::abs(answer.dy_px - truth.dy_px) <= tolerance_px)
    return {};
  char text[160];
  std::snprintf(text, sizeof text,
                "wrong answer: (%.4f, %.4f) px, truth (%.4f, %.4f) px, tolerance %.3f px",
                answer.dx_px, answer.dy_px, truth.dx_px, truth.dy_px, tolerance_px);
  return text;
}

double tolerance_px(Engine engine, PeakFit fit) {
  if (engine == Engine::cross) return 0.3;
  switch (fit) {
    case PeakFit::sinc:
    case PeakFit::gaussian2d:
      return 0.02;
    case PeakFit::gaussian3:
      return 0.06;
    case PeakFit::parabola3:
      return 0.15;
  }
  return 0.0;
}

std::string wrong(const CorrelationPlane& plane, Engine engine, PeakFit fit,
                  const cli::TrueShift& truth) {
  const Peak peak = find_peak(plane, fit);
  if (engine == Engine::phase) {
    return wrong({static_cast<double>(peak.lag_dx_px), static_cast<double>(peak.lag_dy_px)}, truth,
                 1.0);
  }
  return wrong({peak.dx_px, peak.dy_px}, truth, tolerance_px(engine, fit));
}

}  // namespace lsv::bench
