// SPDX-License-Identifier: BSD-3-Clause
// What the fit of the preset `precise` gets out of noise-free speckle: gradient sums, with and
// without the pixels near clipped ones.
#pragma once

#include "calibration/noise_table.h"

namespace lsv::bench {

/// The gradients of a pattern at every saturation of the table.
struct PatternLight {
  /// Without clipping_px2.
  std::array<noise_table::SaturationNode, noise_table::kSaturations> at_saturation;
  noise_table::AlongAcross derivative_gain_1_px2;
};

/// Over `pictures` pictures of new ground. `faint_ratio` > 0 stands for a saturation of 0.
PatternLight measure_light(double speckle_px, double blur_px, double faint_ratio, int pictures);

}  // namespace lsv::bench
