// SPDX-License-Identifier: BSD-3-Clause
// Time: int64 nanoseconds on the clock of the frame source, never double seconds, so that
// epoch stamps keep their resolution; differences are taken in ns and converted once.
#pragma once

#include <compare>
#include <cstdint>

namespace lsv {

inline constexpr std::int64_t kNsPerS = 1'000'000'000;

/// Stamps of files lie within it, 126 years: differences never overflow.
inline constexpr std::int64_t kFarthestStamp_ns = 4'000'000'000'000'000'000;

struct Stamp {
  std::int64_t ns = 0;
  friend auto operator<=>(const Stamp&, const Stamp&) = default;
};

inline double seconds_between(Stamp earlier, Stamp later) {
  return static_cast<double>(later.ns - earlier.ns) / static_cast<double>(kNsPerS);
}

}  // namespace lsv
