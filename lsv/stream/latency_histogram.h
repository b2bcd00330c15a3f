// SPDX-License-Identifier: BSD-3-Clause
// How long things took, in bins 1/64 to 1/128 of their value wide, from 1 ns to 2 h: quantiles to
// 1 % in a fixed 20 kB. One thread adds, any thread reads, nobody waits; the counts that are read
// while one is added may miss that one.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "lsv/core/health_snapshot.h"

namespace lsv {

class LatencyHistogram {
 public:
  /// Negative durations count as 0, longer ones than 2 h as 2 h.
  void add(std::int64_t duration_ns);
  LatencySummary summary() const;

 private:
  static constexpr int kBinsPerOctave = 64;
  static constexpr int kOctaves = 37;
  static constexpr std::size_t kBins = kBinsPerOctave * (kOctaves + 1);

  static std::size_t bin(std::uint64_t duration_ns);
  static double centre_s(std::size_t bin);

  std::array<std::atomic<std::int64_t>, kBins> counts_{};
  std::atomic<std::int64_t> max_ns_{0};
};

}  // namespace lsv
