// SPDX-License-Identifier: BSD-3-Clause
// Constant light on the sensor of a SpeckleCamera, uniform or with a slope: the frames with which a
// camera is characterised (EMVA 1288). The fixed pattern is that of the SpeckleCamera of the same
// settings; the temporal noise differs from the noise of the speckle frames and of other levels of
// light. Units as in sim/speckle.h. One camera belongs to one thread at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "sim/sensor_pattern.h"
#include "sim/speckle.h"

namespace lsv::sim {

class FlatFieldCamera {
 public:
  /// The level of light is config.mean_signal_counts; 0 is dark. `gradient_ratio`: how much more
  /// light falls on the last column than on the first, of the mean, [-1, 1].
  static Result<FlatFieldCamera> create(const SpeckleConfig& config, double gradient_ratio = 0.0);

  /// Fills `out` with frame number `frame`, [0, 2^32), its stamp and index. Any order.
  Result<void> render(std::int64_t frame, Frame& out);

  const SensorPattern& pattern() const { return pattern_; }

 private:
  FlatFieldCamera(const SpeckleConfig& config, double gradient_ratio);

  SpeckleConfig config_;
  SensorPattern pattern_;
  std::vector<double> light_;
};

}  // namespace lsv::sim
