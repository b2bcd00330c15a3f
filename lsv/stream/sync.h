// SPDX-License-Identifier: BSD-3-Clause
// A mutex that lends its owner the priority of whoever waits for it, and a signal that waits until
// an instant of the monotonic clock. std::mutex cannot do the first: a reader of ordinary priority
// that is put aside while it holds the lock would hold up a real-time thread.
#pragma once

#include <pthread.h>

#include <cstdint>

namespace lsv {

/// Meets the Lockable requirements, for std::lock_guard and std::unique_lock.
class PriorityMutex {
 public:
  PriorityMutex();
  ~PriorityMutex() { pthread_mutex_destroy(&mutex_); }
  PriorityMutex(const PriorityMutex&) = delete;
  PriorityMutex& operator=(const PriorityMutex&) = delete;

  void lock() { pthread_mutex_lock(&mutex_); }
  void unlock() { pthread_mutex_unlock(&mutex_); }
  bool try_lock() { return pthread_mutex_trylock(&mutex_) == 0; }

 private:
  friend class Signal;
  pthread_mutex_t mutex_;
};

class Signal {
 public:
  Signal();
  ~Signal() { pthread_cond_destroy(&condition_); }
  Signal(const Signal&) = delete;
  Signal& operator=(const Signal&) = delete;

  void notify() { pthread_cond_broadcast(&condition_); }
  /// Until notified, or until host_now_ns() is `until_ns`, or for no reason at all. `mutex` is
  /// held.
  void wait_until(PriorityMutex& mutex, std::int64_t until_ns);

 private:
  pthread_cond_t condition_;
};

}  // namespace lsv
