// SPDX-License-Identifier: BSD-3-Clause
// The host's monotonic clock, and what a test may put in its place: nothing in a stream looks at
// any other. It cannot be set, and stands still while the machine sleeps.
#pragma once

#include <cstdint>
#include <functional>

namespace lsv {

/// ns since an unknown instant, never falling. Called from any thread.
using MonotonicClock = std::function<std::int64_t()>;

std::int64_t host_now_ns();

}  // namespace lsv
