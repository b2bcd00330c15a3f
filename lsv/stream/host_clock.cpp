// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/host_clock.h"

#include <ctime>

#include "lsv/core/stamp.h"

namespace lsv {

std::int64_t host_now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::int64_t>(now.tv_sec) * kNsPerS + now.tv_nsec;
}

}  // namespace lsv
