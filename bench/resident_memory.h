// SPDX-License-Identifier: BSD-3-Clause
// How much memory the process holds, and how fast that grows.
#pragma once

#include <cstdint>
#include <vector>

namespace lsv::bench {

/// Resident set, bytes; allocates nothing. -1: unknown.
std::int64_t resident_bytes();

/// Least-squares slope of samples taken once a second, bytes per hour; 0 for less than two.
double slope_bytes_per_h(const std::vector<std::int64_t>& per_second_bytes);

}  // namespace lsv::bench
