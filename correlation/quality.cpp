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

/// Standard deviation of what a peak model gets wrong on clean speckle, measured with the
/// simulator; it grows with the width of the peak and falls with the side of the frame.
double fit_error_px(PeakFit fit, double width_variance_px2, double side_px) {
  constexpr double kReferenceSide_px = 128.0;
  constexpr double kPerWidth_1_px = 0.08e-3;
  const auto at_reference = [fit] {
    switch (fit) {
      case PeakFit::sinc:
        return 0.9e-3;
      case PeakFit::gaussian2d:
        return 2.2e-3;
      case PeakFit::gaussian3:
        return 8e-3;
      case PeakFit::parabola3:
        return 20e-3;
    }
    return 20e-3;
  };
  return std::hypot(at_reference(), kPerWidth_1_px * width_variance_px2) * kReferenceSide_px /
         side_px;
}

/// What an engine adds because its plane is not the ZNCC of the overlap: the fall-off with the
/// overlap bends the peak of cross; whitening leaves phase with little but noise beyond the band.
double engine_error_px(Engine engine, double width_variance_px2, double side_px) {
  switch (engine) {
    case Engine::zncc:
    case Engine::direct:
      return 0.0;
    case Engine::cross:
      return 1.25 * width_variance_px2 / side_px;
    case Engine::phase:
      return 9.4 / side_px;
  }
  return 0.0;
}

/// What no model can undo: a plane sampled too coarsely for its peak (speckle of 2 px and less).
/// Fitted to the simulator at 2 and 3 px.
double undersampling_error_px(double width_variance_px2) {
  return std::min(0.3, 4.4e-3 * std::pow(width_variance_px2, -2.75));
}

}  // namespace

double peak_width_px2(const PeakShape& w) {
  return std::sqrt(std::max(0.0, w.xx_px2 * w.yy_px2 - w.xy_px2 * w.xy_px2));
}

double outlier_probability(double zncc_sigmas) {
  constexpr double kOffset = 11.83;
  constexpr double kPerSigma = 3.28;
  return 1.0 / (1.0 + std::exp(kPerSigma * zncc_sigmas - kOffset));
}

double zncc_in_sigmas(double zncc, const PeakShape& shape, double overlap_px) {
  return zncc / std::sqrt(std::numbers::pi * peak_width_px2(shape) / overlap_px);
}

ShiftQuality measure_quality(const CorrelationPlane& plane, const Peak& peak, double overlap_px,
                             std::optional<double> zncc) {
  ShiftQuality out;
  const double plane_top = std::isnan(peak.value) ? peak.lag_value : peak.value;
  out.zncc = zncc.value_or(std::min(1.0, plane_top));
  out.zncc_sigmas = zncc_in_sigmas(out.zncc, peak.shape, overlap_px);
  out.outlier_probability = outlier_probability(out.zncc_sigmas);
  const double top = peak.lag_value;
  if (!(top > 0.0)) return out;  // nothing correlates: ratios to it mean nothing

  const auto total = kernels::sum_abs_and_squares(plane.values.data(), plane.values.size());
  out.q = top * static_cast<double>(plane.values.size()) / total.sum_abs;
  const Background background = background_of(plane, peak_window(plane, peak));
  if (background.sum_squares > 0.0) {
    out.peak_to_rms =
        top / std::sqrt(background.sum_squares / static_cast<double>(background.lags));
    // Nothing positive outside the peak: as unambiguous as the numbers can say.
    out.peak_ratio =
        background.highest > 0.0 ? std::max(1.0, top / background.highest) : out.peak_to_rms;
  }
  return out;
}

ShiftError shift_error(const Peak& peak, double zncc, const FrameStats& earlier,
                       const FrameStats& later, double overlap_px, const ErrorModel& model) {
  constexpr double kSpeckleFactor = 1.6;
  constexpr double kQuantisationVariance_counts2 = 1.0 / 12.0;
  const double noise_variance =
      model.noise_sd_counts * model.noise_sd_counts + kQuantisationVariance_counts2;
  const double pixel_variance = earlier.sd_counts * later.sd_counts;
  const double signal_variance = std::max(pixel_variance - noise_variance, 0.05 * pixel_variance);
  const double pattern_zncc =
      std::clamp(zncc * pixel_variance / signal_variance, 1e-3, 1.0);  // noise taken out

  const PeakShape& w = peak.shape;
  const double r2 = pattern_zncc * pattern_zncc;
  const double decorrelation = kSpeckleFactor * kSpeckleFactor * (1.0 - r2) / r2;
  const double per_w_px2 = (2.0 * noise_variance / signal_variance +
                            std::numbers::pi / 2.0 * decorrelation * peak_width_px2(w)) /
                           overlap_px;
  const double side_px = std::sqrt(overlap_px);
  const auto model_variance = [&](double axis_px2) {
    return std::pow(fit_error_px(peak.fit, axis_px2, side_px), 2) +
           std::pow(undersampling_error_px(axis_px2), 2) +
           std::pow(engine_error_px(model.engine, axis_px2, side_px), 2);
  };
  const double model_x_px2 = model_variance(w.xx_px2);
  const double model_y_px2 = model_variance(w.yy_px2);
  return {.cov = {.xx_px2 = per_w_px2 * w.xx_px2 + model_x_px2,
                  .xy_px2 = per_w_px2 * w.xy_px2,
                  .yy_px2 = per_w_px2 * w.yy_px2 + model_y_px2},
          .model_sigma_x_px = std::sqrt(model_x_px2),
          .model_sigma_y_px = std::sqrt(model_y_px2)};
}

}  // namespace lsv
