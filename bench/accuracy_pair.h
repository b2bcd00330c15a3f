// SPDX-License-Identifier: BSD-3-Clause
// Two simulated frames with their true shift, and the light of the first before the camera spoilt
// it.
#pragma once

#include <stdexcept>
#include <utility>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "sim/speckle.h"
#include "tools/simulated_loop.h"

namespace lsv::bench {

/// These programs end at the first thing that cannot be simulated or set up.
template <typename T>
T require_value(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(result).value();
}

struct SimulatedPair {
  Frame earlier;
  Frame later;
  cli::TrueShift truth;
  std::vector<double> light;  // of `earlier`: mean 1, row-major
};

/// The pattern moves by `shift` per frame, also while the shutter is open. Throws
/// std::runtime_error when `camera` is out of range.
SimulatedPair render(const sim::SpeckleConfig& camera, const cli::TrueShift& shift);

}  // namespace lsv::bench
