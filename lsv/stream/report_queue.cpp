// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/report_queue.h"

#include <mutex>

#include "lsv/stream/host_clock.h"

namespace lsv {

void ReportQueue::on_report(const StreamReport& report, Frame&) {
  const std::lock_guard lock(mutex_);
  if (size_ == slots_.size()) {
    head_ = (head_ + 1) % slots_.size();
    --size_;
    dropped_.fetch_add(1, std::memory_order_relaxed);
  }
  slots_[(head_ + size_) % slots_.size()] = report;
  ++size_;
  signal_.notify();
}

std::optional<StreamReport> ReportQueue::next(std::int64_t timeout_ns) {
  const std::int64_t until_ns = host_now_ns() + timeout_ns;
  const std::lock_guard lock(mutex_);
  while (size_ == 0 && !closed_ && host_now_ns() < until_ns) signal_.wait_until(mutex_, until_ns);
  if (size_ == 0) return std::nullopt;
  const StreamReport out = slots_[head_];
  head_ = (head_ + 1) % slots_.size();
  --size_;
  return out;
}

void ReportQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  signal_.notify();
}

bool ReportQueue::is_empty() {
  const std::lock_guard lock(mutex_);
  return size_ == 0;
}

}  // namespace lsv
