// SPDX-License-Identifier: BSD-3-Clause
// What a camera makes of light: fixed pattern, shot noise, camera noise, rounding, clipping.
#pragma once

#include <cstdint>
#include <vector>

#include "lsv/core/frame.h"
#include "sim/sensor_pattern.h"

namespace lsv::sim {

struct CountsModel {
  double mean_signal_counts = 0.0;  // counts at intensity 1
  double noise_mean_counts = 0.0;
  double noise_sd_counts = 0.0;
  double electrons_per_count = 0.0;  // 0 = no shot noise
  std::uint64_t seed = 0;
  const SensorPattern* pattern = nullptr;  // of the size of the frame; null = none
};

/// Turns `intensity` (row-major, mean 1) into counts in `out`, which has its format already.
/// The noise depends on seed, frame and pixel only. Allocates nothing, throws nothing; any thread.
void to_counts(const CountsModel& model, std::int64_t frame, const std::vector<double>& intensity,
               Frame& out);

}  // namespace lsv::sim
