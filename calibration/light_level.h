// SPDX-License-Identifier: BSD-3-Clause
// What a sequence of frames at one level of light says of all its good pixels together.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibration/measured.h"
#include "calibration/photon_transfer.h"
#include "calibration/pixel_statistics.h"

namespace lsv {

struct LightLevel {
  std::string name;  // of the sequence, for messages
  std::int64_t frames = 0;
  double exposure_us = kUnknown;  // or anything in proportion to the light
  TransferPoint point{};
  double flicker_counts = 0.0;  // standard deviation over time of what all pixels share
  double clipped_share = 0.0;   // of the counts: at full scale when lit, at 0 when dark
  bool saturated = false;       // at or beyond saturation
  bool used = false;            // for K
};

/// Means over the pixels that are not marked in `defect`. `dark`: of the same pixels, or null when
/// `sequence` is the dark itself. Flicker is not noise of a pixel: what all pixels share is taken
/// out of the variance, as EMVA 1288 does with the means of two frames, each pixel in proportion to
/// its light. The sigmas hold what rounding may do to a quiet signal, and in the dark what is cut
/// off at 0.
LightLevel light_level(const PixelStatistics& sequence, const std::vector<std::uint8_t>& defect,
                       const PixelStatistics* dark);

/// sigma_q^2, which rounding to counts adds to a variance.
inline constexpr double kQuantisationVariance_counts2 = 1.0 / 12.0;

/// A variance less that of rounding, 0 at least.
double without_rounding_counts2(double variance_counts2);

/// The part of sigma_q^2 that does not change over time but is in the mean levels of pixels: it is
/// missing from the variance over time and adds to that from pixel to pixel. Noise smears it out.
double still_rounding_counts2(double temporal_variance_counts2);

}  // namespace lsv
