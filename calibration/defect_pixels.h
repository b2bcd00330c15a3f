// SPDX-License-Identifier: BSD-3-Clause
// Pixels that tell nothing, found before anything is computed from the others.
//
//   hot    dark level far above the others, or noise in the dark far out
//   dead   dark level far below, response to light far out, or under a tenth of the others'
//   stuck  one and the same count in every frame, dark or lit
//
// Far out: from the median of the 7 x 7 pixels around (noise: of all), in robust standard
// deviations (1.4826 times the median absolute deviation), so that neither the defects nor uneven
// light decide. The noise is compared as the cube root of the variance, which is close to Gaussian
// (Wilson and Hilferty 1931). The limit follows from the number of pixels: on a sensor whose pixels
// are Gaussian, kFalseDefects are expected.
// Pure functions; they allocate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calibration/pixel_statistics.h"

namespace lsv {

/// Expected on a clean sensor, over all pixels and tests together.
inline constexpr double kFalseDefects = 0.05;

/// The limits that were applied.
struct DefectLimits {
  double sigmas = 0.0;          // of each of them
  double offset_counts = 0.0;   // dark level, from the pixels around
  double noise_counts = 0.0;    // standard deviation over time in the dark
  double response_ratio = 0.0;  // response, from 1
};

struct DefectCounts {
  std::size_t hot = 0;
  std::size_t dead = 0;
  std::size_t stuck = 0;  // of them
};

/// 1: defect. Row-major.
struct DefectPixels {
  std::vector<std::uint8_t> defect;
  DefectCounts counts;
  DefectLimits limits;
};

/// What the dark frames tell; two of them at least.
DefectPixels find_dark_defects(const PixelStatistics& dark);

/// Adds what only light tells. `flat`: as bright as possible without saturating.
void add_lit_defects(const PixelStatistics& dark, const PixelStatistics& flat, DefectPixels& out);

}  // namespace lsv
