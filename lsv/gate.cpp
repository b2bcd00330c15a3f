// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/gate.h"

#include <algorithm>
#include <cmath>

namespace lsv {
namespace {

// A frame at rest matches itself up to its noise, and has no other peak that chance does not make.
constexpr double kRest_px = 1.5;
constexpr double kRestZncc = 0.95;
constexpr double kSecondPeakSigmas = 8.0;

// An error of 0.05 px or of 5 sigma comes with rows that scatter by no less than a quarter of that.
constexpr double kLeastMove_px = 0.02;
constexpr double kLeastMoveSigmas = 1.4;
// Of the ZNCC, between 0 and 1: a tenth of the rows that have nothing in common with the others.
constexpr double kLeastChange = 0.15;
// Beyond chance. Shifts of rows have longer tails than the normal distribution: two in some 4000
// good frames were beyond 4.5 sigma.
constexpr double kMovedSigmas = 6.0;
constexpr double kChangedSigmas = 4.5;

/// Two patterns, of which the one that stays is the stronger.
bool is_held_by_static_pattern(const Shift& shift) {
  const double second_peak_sigmas = shift.quality.zncc_sigmas / shift.quality.peak_ratio;
  return std::max(std::abs(shift.dx_px), std::abs(shift.dy_px)) < kRest_px &&
         shift.quality.zncc < kRestZncc && second_peak_sigmas > kSecondPeakSigmas;
}

}  // namespace

ShiftStatus judge_frame(const FrameFormat& format, const FrameStats& stats, const GateConfig& gate,
                        const Calibration& camera) {
  constexpr double kQuantisationSd_counts = 0.289;  // 1 / sqrt(12)
  if (stats.saturated_fraction > gate.max_saturated_fraction) return ShiftStatus::saturated;
  const double signal_counts = stats.mean_counts - camera.noise_mean_counts;
  if (signal_counts < gate.min_signal_fraction * full_scale_counts(format.bit_depth))
    return ShiftStatus::dark;
  const double noise_counts = std::max(camera.noise_sd_counts, kQuantisationSd_counts);
  if (stats.sd_counts < gate.min_contrast_to_noise * noise_counts) return ShiftStatus::low_contrast;
  return ShiftStatus::ok;
}

bool refuses_repeats(const GateConfig& gate, const Calibration& camera) {
  return gate.refuse_frozen && camera.noise_sd_counts > 0.0;
}

ShiftStatus judge_shift(const Shift& shift, const GateConfig& gate) {
  if (shift.status != ShiftStatus::ok) return shift.status;
  // Written so that NaN fails.
  if (!(shift.quality.zncc >= gate.min_zncc)) return ShiftStatus::below_zncc_gate;
  if (!(shift.quality.zncc_sigmas >= gate.min_zncc_sigmas)) return ShiftStatus::below_zncc_gate;
  if (!(shift.quality.peak_ratio >= gate.min_peak_ratio)) return ShiftStatus::ambiguous;
  if (!(shift.quality.q >= gate.min_q)) return ShiftStatus::below_q_gate;
  return ShiftStatus::ok;
}

ShiftStatus judge_search(const Shift& shift, const GateConfig& gate) {
  const ShiftStatus status = judge_shift(shift, gate);
  if (status == ShiftStatus::ok && is_held_by_static_pattern(shift))
    return ShiftStatus::static_pattern;
  return status;
}

ShiftStatus judge_rows(const RowAgreement& rows, const ShiftCovariance& cov) {
  const double sigma_px = std::sqrt(std::max(cov.xx_px2, cov.yy_px2));
  const bool moved = rows.moved_sigmas > kMovedSigmas &&
                     rows.moved_px > std::max(kLeastMove_px, kLeastMoveSigmas * sigma_px);
  const bool changed = rows.changed_sigmas > kChangedSigmas && rows.changed > kLeastChange;
  return moved || changed ? ShiftStatus::inconsistent : ShiftStatus::ok;
}

Shift with_status(const Shift& shift, ShiftStatus status) {
  if (status == ShiftStatus::ok) return shift;
  Shift out;
  out.quality = shift.quality;
  out.status = status;
  return out;
}

}  // namespace lsv
