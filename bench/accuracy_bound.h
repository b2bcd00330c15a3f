// SPDX-License-Identifier: BSD-3-Clause
// The Cramer-Rao bound of a shift between two frames, for the noise of the pixels alone: boiling,
// interpolation and clipped pixels add to it.
#pragma once

#include "bench/accuracy_pair.h"

namespace lsv::bench {

/// Least variance along each axis that an unbiased estimator can have.
struct ShiftBound {
  double xx_px2 = 0.0;
  double yy_px2 = 0.0;
};

/// (v1 + v2) (sum of g g^T)^-1 over the pixels that both frames see and that are not clipped, with
/// g the gradient of the light in counts per px and v = sd^2 + 1/12 + (full scale / full well) mean
/// signal the variance of a pixel of one frame, counts^2.
ShiftBound cramer_rao_bound(const sim::SpeckleConfig& camera, const SimulatedPair& pair);

}  // namespace lsv::bench
