// SPDX-License-Identifier: BSD-3-Clause
// Every measured duration of one kind, kept, so that percentiles are exact. Memory is taken at
// construction; add() does not allocate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lsv::cli {

/// Nanoseconds of the clock that paces the frames (CLOCK_MONOTONIC).
std::int64_t clock_now_ns();

/// Microseconds; NaN without samples. pNN is the smallest duration that NN % of the samples do not
/// exceed.
struct DurationSummary {
  std::size_t samples = 0;
  double mean_us;
  double p50_us;
  double p99_us;
  double p999_us;
  double max_us;
};

class DurationSamples {
 public:
  explicit DurationSamples(std::size_t capacity) { ns_.reserve(capacity); }

  /// Ignored once `capacity` is reached.
  void add(std::int64_t duration_ns) {
    if (ns_.size() < ns_.capacity()) ns_.push_back(duration_ns);
  }

  std::size_t count_above(std::int64_t limit_ns) const;
  DurationSummary summary() const;

 private:
  std::vector<std::int64_t> ns_;
};

}  // namespace lsv::cli
