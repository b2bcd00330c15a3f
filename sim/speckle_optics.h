// SPDX-License-Identifier: BSD-3-Clause
// The optics of the simulated sensor as plain numbers: the amplitude point spread of a circular
// aperture, the pixel as a filter, and the nodes of the exposure. Lengths are in samples of the
// simulation grid. Pure functions; those that return a vector allocate it; any thread.
//
// Speckle size. Behind a hard circular aperture of diameter D the intensity autocovariance is
// |2 J1(pi r/s) / (pi r/s)|^2 with s = lambda z / D (Goodman, Speckle Phenomena in Optics, 2nd
// ed., sec. 5.2 and 5.4), whose full width at half maximum is kHardApertureFwhm * s. Here the
// point spread is cut off smoothly at the radius kKernelRadius * s, which softens the edge of the
// aperture; the same width becomes kSoftApertureFwhm * s and s is chosen so that the width is
// the one asked for. The shape then differs from the hard aperture's by less than 0.003.
#pragma once

#include <vector>

namespace lsv::sim {

inline constexpr double kHardApertureFwhm = 1.0289940;  // 2 x / pi with |2 J1(x)/x|^2 = 1/2
inline constexpr double kSoftApertureFwhm = 1.0717980;
inline constexpr double kKernelRadius = 12.0;

/// Amplitude point spread at distance `r` from its centre, 1 at r = 0, 0 from kKernelRadius * s on.
double point_spread(double r, double s);

/// Weights that turn intensity samples into the mean over a square pixel of side `side` centred
/// on the middle weight, along one axis: w[k] = 1/side * integral over the pixel of a windowed
/// sinc at k. The length is odd. Exact for intensities of the aperture scale `s`, s > 2 (the band
/// edge is 1/s, the sampling limit 1/2). side = 0 gives the single weight 1.
std::vector<double> pixel_weights(double side, double s);

/// Gauss-Legendre nodes on [-1/2, 1/2] with weights that sum to 1.
struct ExposureNode {
  double time_ratio;
  double weight;
};
/// Enough nodes for 1e-6 relative accuracy when the pattern moves `path` during the exposure.
std::vector<ExposureNode> exposure_nodes(double path, double s);

}  // namespace lsv::sim
