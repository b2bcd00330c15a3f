// SPDX-License-Identifier: BSD-3-Clause
// What the simulator says about laser speckle and about the preset `precise`, for
// calibration/noise_model.h: the numbers of noise_table.cpp, which bench/noise_table.cpp writes.
//
// Light is in units of its mean. x runs along the motion. "Saturation" is the mean signal over the
// signal at full scale. N: pixels that the fit uses. Figures in px2 give px once divided by
// sqrt(N).
#pragma once

#include <array>
#include <cstddef>

namespace lsv::noise_table {

inline constexpr std::size_t kSpeckles = 5;
inline constexpr std::size_t kBlurs = 6;
inline constexpr std::size_t kSaturations = 7;

/// Full width at half maximum of the autocovariance of the intensity before pixel integration.
inline constexpr std::array<double, kSpeckles> kSpeckle_px = {2.5, 3.0, 4.0, 6.0, 9.0};
/// Path during the exposure, in speckle sizes.
inline constexpr std::array<double, kBlurs> kBlur_ratio = {0.0, 0.5, 0.75, 1.0, 1.25, 1.5};
inline constexpr std::array<double, kSaturations> kSaturation_ratio = {0.0, 0.15, 0.2, 0.25,
                                                                       0.3, 0.35, 0.4};

struct AlongAcross {
  double x = 0.0;
  double y = 0.0;
};

/// A pattern of which some pixels are clipped, as one of the two ways to fit it sees it.
struct ClippedFit {
  AlongAcross gradient_1_px2;  // mean square of the gradient over all pixels, those left out as 0
  AlongAcross light_ratio;     // mean light, weighted by the square of the gradient
  AlongAcross clipping_px2;    // error that clipping alone leaves
};

/// One saturation.
struct SaturationNode {
  ClippedFit whole;               // clipped pixels used like the others
  ClippedFit skipping;            // pixels within reach of a clipped one left out
  double variance_ratio = 0.0;    // of the pattern, all pixels
  double used_ratio = 0.0;        // share of the pixels that `skipping` uses
  double used_light_ratio = 0.0;  // their mean light over the variance of it
  double spread_px2 = 0.0;        // N times the relative variance of their gradient sums
};

/// One speckle size and blur.
struct PatternNode {
  AlongAcross boiling_px2;            // error at F = 1, see noise_model.h
  AlongAcross smallest_px;            // what interpolation leaves however many pixels there are
  AlongAcross interpolation_px2;      // and what falls with their number
  AlongAcross derivative_gain_1_px2;  // noise variance of a gradient over that of a pixel
  std::array<SaturationNode, kSaturations> at_saturation{};
};

extern const std::array<std::array<PatternNode, kBlurs>, kSpeckles> kPatterns;

}  // namespace lsv::noise_table
