// SPDX-License-Identifier: BSD-3-Clause
// What keeps other programs and the pager from delaying a stream, where the system allows it. None
// of it is needed for a stream to run: a refusal is a warning.
#pragma once

#include <pthread.h>

#include "lsv/core/result.h"

namespace lsv {

/// All memory of the process that is mapped now stays in RAM. invalid_argument, naming the limit to
/// raise, when the system refuses.
Result<void> lock_memory();

/// `priority` in [1, 99] of SCHED_FIFO. Its threads must wait, never spin.
Result<void> set_fifo_priority(pthread_t thread, int priority);

}  // namespace lsv
