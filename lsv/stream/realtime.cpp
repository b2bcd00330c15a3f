// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/realtime.h"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace lsv {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

}  // namespace

// Not MCL_FUTURE: with a limit on locked memory it would make later allocations fail.
Result<void> lock_memory() {
  if (mlockall(MCL_CURRENT) == 0) return {};
  return Error{ErrorCode::invalid_argument,
               "memory cannot be locked (" + reason(errno) +
                   "): raise the limit 'ulimit -l' or grant CAP_IPC_LOCK"};
}

Result<void> set_fifo_priority(pthread_t thread, int priority) {
  const sched_param parameters{.sched_priority = priority};
  const int error = pthread_setschedparam(thread, SCHED_FIFO, &parameters);
  if (error == 0) return {};
  return Error{ErrorCode::invalid_argument,
               "real-time priority " + std::to_string(priority) + " is refused (" + reason(error) +
                   "): raise the limit 'ulimit -r' or grant CAP_SYS_NICE"};
}

}  // namespace lsv
