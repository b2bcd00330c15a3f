// SPDX-License-Identifier: BSD-3-Clause
// How good a correlation is (measured, never judged: the gate judges) and how uncertain its shift.
//
//   zncc         ZNCC of the two frames at the peak. For the zncc and direct engines the fitted
//                maximum of the plane, at most 1; for cross and phase, whose planes are scaled
//                otherwise, the exact ZNCC at the highest whole lag.
//   q            highest value of the plane / mean of |plane| over all lags searched: the
//                "peak to mean level" of the Masuku thesis (3.4.1). It is no coefficient: it
//                depends on window, speckle size and search range, so a limit is per data set.
//   peak_ratio   highest value / highest value outside the peak (beyond 3 sigma of its width,
//                at least 3 px).
//   peak_to_rms  highest value / rms of the plane outside the peak.
//   zncc_sigmas  zncc / sqrt(pi sqrt|W| / N): what the ZNCC of two unrelated patterns with this
//                width of peak W scatters over N pixels of overlap. Unlike q it means the same
//                for every window, speckle size and lag. NaN when the peak has no shape.
#pragma once

#include <optional>

#include "correlation/correlator.h"
#include "correlation/peak.h"
#include "lsv/core/shift.h"

namespace lsv {

/// `plane` must be the one that `peak` was found in. `zncc` is known already unless the plane
/// itself is a ZNCC: then it is empty.
ShiftQuality measure_quality(const CorrelationPlane& plane, const Peak& peak, double overlap_px,
                             std::optional<double> zncc = std::nullopt);

/// Probability that the highest peak over all lags is not the one of the motion. A logistic model
/// of zncc_sigmas, fitted to 3414 simulated pairs (48 to 128 px, 3 to 8 px speckle, correlation 0
/// to 0.6, 1416 of them wrong). Q and the peak ratio say far less (log likelihood -1111 against
/// -514) and add nothing to it.
double outlier_probability(double zncc_sigmas);

/// What the covariance rests on besides the peak itself.
struct ErrorModel {
  double noise_sd_counts = 0.0;  // temporal noise of one pixel in either frame
  Engine engine = Engine::zncc;
};

/// sqrt|W|, px^2: the squared width of the peak, geometric mean over its axes.
double peak_width_px2(const PeakShape& shape);

/// zncc / sqrt(pi sqrt|W| / N), see zncc_sigmas above.
double zncc_in_sigmas(double zncc, const PeakShape& shape, double overlap_px);

struct ShiftError {
  ShiftCovariance cov;
  double model_sigma_x_px = kUnknown;  // the share of the last term below, included in cov
  double model_sigma_y_px = kUnknown;
};

/// Covariance of the sub-pixel shift, as the sum of three terms (W = peak.shape, N = pixels in
/// the overlap, |W| its determinant):
///  - camera noise: 2 sigma_n^2 / (N sigma_I^2) W, the Cramer-Rao bound of a shift between two
///    frames with white noise (Robinson and Milanfar 2004);
///  - decorrelation: k^2 (pi/2) (1 - r^2) / r^2 sqrt|W| W / N, with r the ZNCC that is left once
///    camera noise is accounted for. The factor without k holds for stationary Gaussian
///    patterns; k = 1.6 for speckle intensity, measured with the simulator;
///  - the error of the engine, of the peak model and of a peak sampled too coarsely, per axis,
///    measured with the simulator.
/// Tested: errors over sigma have an rms between 0.4 and 1.6 in the conditions of accuracy_test.
ShiftError shift_error(const Peak& peak, double zncc, const FrameStats& earlier,
                       const FrameStats& later, double overlap_px, const ErrorModel& model);

}  // namespace lsv
