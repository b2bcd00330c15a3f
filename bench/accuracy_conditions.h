// SPDX-License-Identifier: BSD-3-Clause
// The conditions under which shifts are measured: what the camera sees and how far the pattern
// moves between the two frames of a pair. The same pair number has the same ground and, where the
// range of shifts is the same, the same shift in every condition, so that conditions compare.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "sim/speckle.h"
#include "tools/simulated_loop.h"

namespace lsv::bench {

/// Full width at half maximum of the intensity autocovariance.
inline constexpr double kSpeckleSizes_px[] = {3.0, 4.0, 6.0};
inline constexpr int kSpeckleSizes = 3;

enum class ShiftLaw {
  uniform,  // each axis on its own, within +-range_px
  circle,   // of length range_px in any direction
};

struct Condition {
  std::string_view name;
  std::string_view meaning;
  ShiftLaw law = ShiftLaw::uniform;
  double range_px = 3.0;
  sim::SpeckleConfig camera{};           // speckle size and seed are set for each pair
  std::optional<int> max_shift_px = {};  // of lsv, where its default is too small
  int template_px = 96;                  // of cv::matchTemplate
};

/// Every condition, in the order of the report.
const std::vector<Condition>& conditions();

/// Throws std::out_of_range when there is none of that name.
const Condition& condition_named(std::string_view name);

std::uint64_t pair_seed(int pair);
cli::TrueShift true_shift(const Condition& condition, int pair);

}  // namespace lsv::bench
