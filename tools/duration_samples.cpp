// SPDX-License-Identifier: BSD-3-Clause
#include "tools/duration_samples.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

#include "lsv/core/shift.h"
#include "lsv/core/stamp.h"

namespace lsv::cli {

std::int64_t clock_now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::int64_t>(now.tv_sec) * kNsPerS + now.tv_nsec;
}

std::size_t DurationSamples::count_above(std::int64_t limit_ns) const {
  return static_cast<std::size_t>(
      std::count_if(ns_.begin(), ns_.end(), [=](std::int64_t ns) { return ns > limit_ns; }));
}

DurationSummary DurationSamples::summary() const {
  if (ns_.empty()) return {0, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown};
  std::vector<std::int64_t> sorted = ns_;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  // Nearest rank, in whole numbers: ceil(n * per_mille / 1000).
  const auto at = [&](std::size_t per_mille) {
    return static_cast<double>(sorted[(n * per_mille + 999) / 1000 - 1]) / 1e3;
  };
  const double sum_ns = std::accumulate(sorted.begin(), sorted.end(), 0.0);
  return {.samples = n,
          .mean_us = sum_ns / static_cast<double>(n) / 1e3,
          .p50_us = at(500),
          .p99_us = at(990),
          .p999_us = at(999),
          .max_us = at(1000)};
}

}  // namespace lsv::cli
