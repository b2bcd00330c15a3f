// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "correlation/kernels.h"

namespace lsv {
namespace {

/// Lags that belong to the peak: everything else is background.
struct PeakWindow {
  int min_dx, max_dx, min_dy, max_dy;  // inclusive, clipped to the plane
};

PeakWindow peak_window(const CorrelationPlane& plane, const Peak& peak) {
  constexpr double kDefaultSigma_px = 1.7;  // 4 px speckle
  const auto radius = [](double variance_px2) {
    const double sigma_px = std::isnan(variance_px2) ? kDefaultSigma_px : std::sqrt(variance_px2);
    return static_cast<int>(std::lround(std::clamp(3.0 * sigma_px, 3.0, 1000.0)));
  };
  const int rx = radius(peak.shape.xx_px2);
  const int ry = radius(peak.shape.yy_px2);
  const LagRange& lags = plane.lags;
  return {.min_dx = std::max(peak.lag_dx_px - rx, -lags.max_dx_px),
          .max_dx = std::min(peak.lag_dx_px + rx, lags.max_dx_px),
          .min_dy = std::max(peak.lag_dy_px - ry, -lags.max_dy_px),
          .max_dy = std::min(peak.lag_dy_px + ry, lags.max_dy_px)};
}

struct Background {
  double highest = kUnknown;
  double sum_squares = 0.0;
  std::size_t lags = 0;

  void add(const float* values, int n) {
    if (n <= 0) return;
    const auto count = static_cast<std::size_t>(n);
    const double row_max = kernels::max_value(values, count);
    highest = std::isnan(highest) ? row_max : std::max(highest, row_max);
    sum_squares += kernels::sum_abs_and_squares(values, count).sum_squares;
    lags += count;
  }
};

Background background_of(const CorrelationPlane& plane, const PeakWindow& window) {
  Background out;
  const LagRange& lags = plane.lags;
  for (int dy = -lags.max_dy_px; dy <= lags.max_dy_px; ++dy) {
    const float* const row = plane.row(dy);
    if (dy < window.min_dy || dy > window.max_dy) {
      out.add(row, plane.width());
    } else {
      out.add(row, window.min_dx + lags.max_dx_px);
      out.add(row + window.max_dx + 1 + lags.max_dx_px, lags.max_dx_px - window.max_dx);
    }
  }
  return out;
}

/// Error of the 3 x 3 peak models on fully developed speckle, as the (1 - r^2) / r^2 that would
/// scatter the shift as much.
double model_error(PeakFit fit) {
  switch (fit) {
    case PeakFit::gaussian2d:
      return 0.0075;
    case PeakFit::gaussian3:
      return 0.06;
    case PeakFit::parabola3:
      return 0.2;
  }
  return 0.2;
}

}  // namespace

ShiftQuality measure_quality(const CorrelationPlane& plane, const Peak& peak) {
  ShiftQuality out;
  const auto total = kernels::sum_abs_and_squares(plane.values.data(), plane.values.size());
  const Background background = background_of(plane, peak_window(plane, peak));
  const double top = peak.lag_value;
  const double mean_abs = total.sum_abs / static_cast<double>(plane.values.size());
  if (mean_abs > 0.0) out.q = top / mean_abs;
  if (background.lags > 0 && background.sum_squares > 0.0) {
    out.peak_to_rms =
        top / std::sqrt(background.sum_squares / static_cast<double>(background.lags));
    // Nothing positive outside the peak: as unambiguous as the numbers can say.
    out.peak_ratio =
        background.highest > 0.0 ? std::max(1.0, top / background.highest) : out.peak_to_rms;
  }
  out.zncc = std::min(1.0, std::isnan(peak.value) ? peak.lag_value : peak.value);
  return out;
}

ShiftCovariance shift_covariance(const Peak& peak, double zncc, const FrameStats& earlier,
                                 const FrameStats& later, double overlap_px,
                                 const NoiseModel& noise) {
  constexpr double kSpeckleFactor = 1.9;
  constexpr double kQuantisationVariance_counts2 = 1.0 / 12.0;
  const double noise_variance =
      noise.noise_sd_counts * noise.noise_sd_counts + kQuantisationVariance_counts2;
  const double pixel_variance = earlier.sd_counts * later.sd_counts;
  const double signal_variance = std::max(pixel_variance - noise_variance, 0.05 * pixel_variance);
  const double pattern_zncc =
      std::clamp(zncc * pixel_variance / signal_variance, 1e-3, 1.0);  // noise taken out

  const PeakShape& w = peak.shape;
  const double det = std::max(0.0, w.xx_px2 * w.yy_px2 - w.xy_px2 * w.xy_px2);
  const double r2 = pattern_zncc * pattern_zncc;
  const double decorrelation =
      kSpeckleFactor * kSpeckleFactor * ((1.0 - r2) / r2 + model_error(noise.fit));
  const double per_w_px2 = (2.0 * noise_variance / signal_variance +
                            std::numbers::pi / 2.0 * decorrelation * std::sqrt(det)) /
                           overlap_px;
  return {.xx_px2 = per_w_px2 * w.xx_px2,
          .xy_px2 = per_w_px2 * w.xy_px2,
          .yy_px2 = per_w_px2 * w.yy_px2};
}

}  // namespace lsv
