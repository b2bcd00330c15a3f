// SPDX-License-Identifier: BSD-3-Clause
// A whole drive through the navigator: one row for each time at which there was a sample, and,
// where samples stay away, rows that are predicted: at the instant at which the status changes and,
// while nothing tells the speed, every `optical_timeout_s` or 50 to a gap.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "fusion/navigator.h"
#include "tools/fuse_inputs.h"

namespace lsv::cli {

/// What came at one time and what the navigator made of it.
struct FuseRow {
  NavState state;
  bool is_predicted = false;  // nothing came; no agreement is told
  std::optional<WheelSample> wheels{};
  std::array<std::optional<LsvSample>, kMaxLsvSensors> lsv{};
  std::optional<GyroSample> gyro{};
};

/// Hands every row to `row`, which ends the run with its error.
Result<FusionCounters> fuse(const FusionConfig& config, const FuseSamples& samples,
                            const std::function<Result<void>(const FuseRow&)>& row);

}  // namespace lsv::cli
