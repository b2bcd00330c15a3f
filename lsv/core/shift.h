// SPDX-License-Identifier: BSD-3-Clause
// The shift of the speckle pattern from an earlier frame to a later one, with its quality and
// its status. Positive dx: the pattern moved to a larger column; positive dy: to a larger row.
#pragma once

#include <array>
#include <limits>
#include <string_view>

namespace lsv {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Lags searched: columns -max_dx_px..max_dx_px, rows -max_dy_px..max_dy_px.
struct LagRange {
  int max_dx_px = 0;
  int max_dy_px = 0;
  friend bool operator==(const LagRange&, const LagRange&) = default;
};

/// Why a shift may, or may not, be used. Every value but `ok` leaves the numbers NaN.
enum class ShiftStatus {
  ok,
  first_frame,      // there is no earlier frame to compare with
  dark,             // mean signal too small: laser off, lens covered
  saturated,        // too many pixels at full scale
  low_contrast,     // pixel spread no larger than camera noise: no pattern to follow
  frozen,           // bit-identical to the frame before, on a camera that has noise
  peak_at_border,   // correlation still rises at the edge of the search range
  flat_peak,        // the neighbourhood of the peak has no shape that the fit accepts
  ambiguous,        // a second peak is nearly as high
  static_pattern,   // the frames match at rest, but part of them also somewhere else
  inconsistent,     // some rows do not show the motion of the others
  below_zncc_gate,  // peak ZNCC under GateConfig::min_zncc or min_zncc_sigmas
  below_q_gate,     // Q under GateConfig::min_q
};

/// The word used in every output (`ok`, `peak_at_border`, ...).
std::string_view word(ShiftStatus status);
/// One sentence for a person: what it means and what to try.
std::string_view advice(ShiftStatus status);

inline constexpr std::array kAllShiftStatuses = {ShiftStatus::ok,
                                                 ShiftStatus::first_frame,
                                                 ShiftStatus::dark,
                                                 ShiftStatus::saturated,
                                                 ShiftStatus::low_contrast,
                                                 ShiftStatus::frozen,
                                                 ShiftStatus::peak_at_border,
                                                 ShiftStatus::flat_peak,
                                                 ShiftStatus::ambiguous,
                                                 ShiftStatus::static_pattern,
                                                 ShiftStatus::inconsistent,
                                                 ShiftStatus::below_zncc_gate,
                                                 ShiftStatus::below_q_gate};

/// Measured values only, never codes. NaN where a value could not be measured.
/// Definitions with formulas: docs/conventions.md.
struct ShiftQuality {
  double zncc = kUnknown;         // zero-normalised cross-correlation at the peak, [-1, 1]
  double q = kUnknown;            // peak / mean |plane| over all lags searched, >= 1
  double peak_ratio = kUnknown;   // highest / second highest peak of the plane, >= 1
  double peak_to_rms = kUnknown;  // peak / rms of the plane outside the peak
  double zncc_sigmas = kUnknown;  // zncc / its standard deviation between unrelated patterns
  double outlier_probability = kUnknown;  // that the peak of a full search is the wrong one, [0, 1]
};

/// Symmetric 2 x 2 covariance in px^2.
struct ShiftCovariance {
  double xx_px2 = kUnknown;
  double xy_px2 = kUnknown;
  double yy_px2 = kUnknown;
};

struct Shift {
  double dx_px = kUnknown;
  double dy_px = kUnknown;
  ShiftCovariance cov;
  /// The part of the sigmas that engine, peak model and sampling account for. It is in `cov`;
  /// unlike the rest it repeats when the motion repeats, so over a steady drive it adds up
  /// linearly.
  double model_sigma_x_px = kUnknown;
  double model_sigma_y_px = kUnknown;
  ShiftQuality quality;
  ShiftStatus status = ShiftStatus::first_frame;
};

}  // namespace lsv
