// SPDX-License-Identifier: BSD-3-Clause
// Conditions at which the predictions of calibration/noise_model.h are held against simulated and
// tracked frames. None of them is a node of its table.
#pragma once

#include <vector>

#include "bench/noise_pairs.h"
#include "calibration/noise_model.h"

namespace lsv::bench {

struct NoisePoint {
  int side_px = 128;
  double speckle_px = 4.0;
  double blur_px = 0.0;
  double mean_counts = 60.0;
  double noise_sd_counts = 0.5;
  int bit_depth = 8;
  double full_well_electrons = 0.0;  // 0: no shot noise
  double rho = 1.0;
  double shift_px = 0.0;
};

/// Twelve, spread over windows, speckle, blur, light, noise, bit depth, boiling and shift.
const std::vector<NoisePoint>& noise_points();

NoiseConditions conditions_of(const NoisePoint& point);
/// Of one window.
sim::SpeckleConfig camera_of(const NoisePoint& point);
LightSetup light_of(const NoisePoint& point);

PairErrors simulate(const NoisePoint& point, int pairs);

}  // namespace lsv::bench
