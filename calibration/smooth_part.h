// SPDX-License-Identifier: BSD-3-Clause
// The smooth part of a picture of the sensor: uneven light, as against the pixels.
//
// A polynomial of degree 4 in x and y (least squares), then what a low-pass leaves of the rest: the
// filters of EMVA 1288 release 4.0, section 8.1 (box 7 x 7, box 11 x 11, binomial 3 x 3). Without
// the polynomial the filter would mistake a slope for a pattern along the borders, where half of it
// lies outside the picture. Pixels marked in `defect` are left out, and pixels outside too.
//
// Pure functions; they allocate. Values are row-major, width_px x height_px.
#pragma once

#include <cstdint>
#include <vector>

namespace lsv {

std::vector<double> smooth_part(const std::vector<double>& values,
                                const std::vector<std::uint8_t>& defect, int width_px,
                                int height_px);

/// What is left of the standard deviation of an uncorrelated pattern when its smooth part is taken
/// out, 0.994: the low-pass takes a little of each pixel along.
double high_pass_gain();

}  // namespace lsv
