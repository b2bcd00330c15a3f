// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/tracker.h"

#include <algorithm>
#include <cmath>

#include "correlation/peak.h"
#include "correlation/quality.h"

namespace lsv {
namespace {

/// Squared width of the autocorrelation from lags 1 and 2, which camera noise does not reach.
double autocorrelation_variance_px2(double at_1_px, double at_2_px) {
  constexpr double kSmallest_px2 = 0.1;
  if (!(at_1_px > 0.0)) return kSmallest_px2;
  // A pattern finer than that is taken for the finest.
  return at_2_px > 0.0 && at_2_px < at_1_px ? 1.5 / std::log(at_1_px / at_2_px) : kSmallest_px2;
}

struct SpeckleSize {
  double fwhm_x_px = 0.0;
  double fwhm_y_px = 0.0;
};

SpeckleSize speckle_size(const TrackFrame& frame) {
  LagWindow along_x, along_y;
  SpeckleSize out;
  if (!lag_window_at(frame, frame, 1, 0, along_x) || !lag_window_at(frame, frame, 0, 1, along_y))
    return out;
  out.fwhm_x_px = speckle_fwhm_px(autocorrelation_variance_px2(along_x.zncc[4], along_x.zncc[5]));
  out.fwhm_y_px = speckle_fwhm_px(autocorrelation_variance_px2(along_y.zncc[4], along_y.zncc[7]));
  return out;
}

int whole_lag(double guess_px, int side_px) {
  const double limit = side_px;
  return static_cast<int>(std::lround(std::clamp(guess_px, -limit, limit)));
}

ShiftCovariance sum(const ShiftCovariance& a, const ShiftCovariance& b) {
  return {a.xx_px2 + b.xx_px2, a.xy_px2 + b.xy_px2, a.yy_px2 + b.yy_px2};
}

}  // namespace

Tracker::Tracker(const FrameFormat& format, Refinement refinement, double noise_sd_counts)
    : format_(format),
      refinement_(refinement),
      noise_sd_counts_(noise_sd_counts),
      icgn_(refinement == Refinement::icgn ? IcGn(format) : IcGn()) {
  (void)speckle_kernel(0.0);  // makes the set, which allocates, before the first frame
}

void Tracker::build(const TrackFrame& frame, TrackReference& reference) const {
  if (refinement_ == Refinement::none) return;
  const SpeckleSize size = speckle_size(frame);
  reference.build(frame, size.fwhm_x_px, size.fwhm_y_px);
}

void Tracker::set_holes(const std::vector<std::uint8_t>& is_hole) {
  has_holes_ =
      std::any_of(is_hole.begin(), is_hole.end(), [](std::uint8_t hole) { return hole != 0; });
  if (refinement_ == Refinement::icgn) icgn_.set_holes(is_hole);
}

TrackedShift Tracker::measure(const TrackFrame& earlier, const TrackReference& reference,
                              const TrackFrame& later, double guess_dx_px, double guess_dy_px) {
  TrackedShift out;
  Shift& shift = out.shift;
  const LagWindow window = climb(earlier, later, whole_lag(guess_dx_px, format_.width_px),
                                 whole_lag(guess_dy_px, format_.height_px));
  shift.status = ShiftStatus::peak_at_border;
  if (!window.found) return out;
  const Peak peak = fit_nine_lags(window.zncc, window.dx_px, window.dy_px);
  shift.status = peak.status;
  shift.quality.zncc = std::min(1.0, peak.status == ShiftStatus::ok ? peak.value : peak.lag_value);
  shift.quality.zncc_sigmas = zncc_in_sigmas(shift.quality.zncc, peak.shape, window.overlap_px);
  if (peak.status != ShiftStatus::ok) return out;
  if (!has_holes_) out.rows = row_probe_.measure(earlier, later, window, peak);

  const Refined refined =
      refinement_ == Refinement::icgn ? icgn_.refine(reference, later, peak, window) : Refined{};
  if (refined.converged) {
    shift.dx_px = refined.dx_px;
    shift.dy_px = refined.dy_px;
    shift.quality.zncc = refined.zncc;
    shift.quality.zncc_sigmas = zncc_in_sigmas(refined.zncc, peak.shape, window.overlap_px);
    out.noise_cov = refined.noise_cov;
    out.boiling_cov = refined.boiling_cov;
    out.boiling_ratio = refined.boiling_ratio;
    out.refined = true;
    shift.cov = sum(refined.noise_cov, refined.boiling_cov);
    shift.model_sigma_x_px = shift.model_sigma_y_px = 0.0;
    return out;
  }
  shift.dx_px = peak.dx_px;
  shift.dy_px = peak.dy_px;
  const ShiftError error =
      shift_error(peak, shift.quality.zncc, earlier.stats(), later.stats(), window.overlap_px,
                  {.noise_sd_counts = noise_sd_counts_, .engine = Engine::zncc});
  shift.cov = error.cov;
  shift.model_sigma_x_px = error.model_sigma_x_px;
  shift.model_sigma_y_px = error.model_sigma_y_px;
  out.noise_cov = error.cov;
  out.boiling_cov = {0.0, 0.0, 0.0};
  return out;
}

RowAgreement Tracker::rows_at(const TrackFrame& earlier, const TrackFrame& later, double dx_px,
                              double dy_px) {
  LagWindow window;
  if (has_holes_ || !lag_window_at(earlier, later, whole_lag(dx_px, format_.width_px),
                                   whole_lag(dy_px, format_.height_px), window))
    return {};
  Peak peak = fit_nine_lags(window.zncc, window.dx_px, window.dy_px);
  peak.dx_px = dx_px;
  peak.dy_px = dy_px;
  return row_probe_.measure(earlier, later, window, peak);
}

}  // namespace lsv
