// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/sync.h"

#include <algorithm>
#include <ctime>

#include "lsv/core/stamp.h"

namespace lsv {

PriorityMutex::PriorityMutex() {
  pthread_mutexattr_t attributes;
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
  pthread_mutex_init(&mutex_, &attributes);
  pthread_mutexattr_destroy(&attributes);
}

Signal::Signal() {
  pthread_condattr_t attributes;
  pthread_condattr_init(&attributes);
  pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
  pthread_cond_init(&condition_, &attributes);
  pthread_condattr_destroy(&attributes);
}

void Signal::wait_until(PriorityMutex& mutex, std::int64_t until_ns) {
  const std::int64_t at_ns = std::max(std::int64_t{0}, until_ns);
  const timespec until{.tv_sec = at_ns / kNsPerS, .tv_nsec = at_ns % kNsPerS};
  pthread_cond_timedwait(&condition_, &mutex.mutex_, &until);
}

}  // namespace lsv
