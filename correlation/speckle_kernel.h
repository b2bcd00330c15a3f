// SPDX-License-Identifier: BSD-3-Clause
// Interpolation between pixels and differentiation at pixels, by weights made for laser speckle:
// the linear estimate of least variance (ordinary kriging: Cressie, "Statistics for Spatial Data",
// 1993, 3.2) for a pattern whose autocovariance is that of fully developed speckle behind a
// circular aperture (Goodman, "Speckle Phenomena in Optics", 2007, 4.4) averaged over a pixel.
// Weights made for a speckle a little smaller than the true one lose nothing; weights made for a
// larger one miss the finest detail, so of several sizes the next smaller is the one to take.
#pragma once

#include <array>
#include <vector>

namespace lsv {

/// Pixels -3..4 around the one left of the point.
inline constexpr int kKernelTaps = 8;
inline constexpr int kKernelLeft_px = 3;
inline constexpr int kKernelRight_px = 4;
/// A derivative takes pixels -4..4.
inline constexpr int kGradientReach_px = 4;

using KernelWeights = std::array<float, kKernelTaps>;

class SpeckleKernel {
 public:
  /// `fwhm_px`: full width at half maximum of the autocovariance of the intensity before pixel
  /// integration, >= 1. From kSixTapFwhm_px the two outermost weights are zero.
  explicit SpeckleKernel(double fwhm_px);

  double fwhm_px() const { return fwhm_px_; }
  bool has_six_taps() const { return taps_ == 6; }

  /// Weights of the value at `fraction_px` in [0, 1] to the right of pixel 0; their sum is 1.
  KernelWeights weights(double fraction_px) const;

  /// d[j - 1] in the derivative at pixel 0, sum over j = 1..4 of d[j - 1] (I(j) - I(-j)).
  const std::array<float, kGradientReach_px>& derivative_1_px() const { return derivative_1_px_; }

  static constexpr double kSixTapFwhm_px = 3.4;

 private:
  double fwhm_px_;
  int taps_;
  std::vector<KernelWeights> phases_;  // of fractions 0, 1/kPhases, .., 1
  std::array<float, kGradientReach_px> derivative_1_px_{};
};

/// The kernel made for the largest speckle that does not exceed `fwhm_px`, of a fixed set from
/// 1.5 to 9 px; the smallest for NaN. The set is made once and lives to the end of the program.
const SpeckleKernel& speckle_kernel(double fwhm_px);

/// Full width at half maximum of the speckle whose autocovariance near zero lag falls as
/// exp(-lag^2 / (2 variance_px2)).
double speckle_fwhm_px(double variance_px2);

}  // namespace lsv
