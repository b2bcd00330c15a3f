// SPDX-License-Identifier: BSD-3-Clause
// The clocks of the host. Internal to lsv/camera.
#pragma once

#include <chrono>
#include <cstdint>

namespace lsv {

inline std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

inline std::int64_t wall_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace lsv
