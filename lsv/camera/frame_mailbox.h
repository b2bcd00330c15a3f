// SPDX-License-Identifier: BSD-3-Clause
// Images on their way from the thread that waits for OpenCV to the one that grabs: a bounded queue
// whose places keep their memory. One writer, one reader.
// Internal to lsv/camera.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lsv/stream/live_source.h"

namespace lsv {

struct MailedImage {
  cv::Mat image;
  FrameLabel label{};
};

class FrameMailbox {
 public:
  explicit FrameMailbox(std::size_t places) : places_(places) {}

  /// The place to fill next, or null while all are taken. The writer fills it and posts it.
  MailedImage* free_place() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return waiting_ < places_.size() ? &places_[(first_ + waiting_) % places_.size()] : nullptr;
  }
  void post() {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++waiting_;
    changed_.notify_one();
  }
  /// There will be no more.
  void close() {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    changed_.notify_one();
  }
  /// Ends a wait of the reader, now and from now on.
  void wake() {
    const std::lock_guard<std::mutex> lock(mutex_);
    woken_ = true;
    changed_.notify_one();
  }

  /// The image that waited longest, or null: none came in time, there are none any more, or
  /// wake(). It is the reader's until done().
  const MailedImage* wait(std::int64_t timeout_ns) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, std::chrono::nanoseconds(timeout_ns),
                      [this] { return waiting_ > 0 || closed_ || woken_; });
    return waiting_ > 0 && !woken_ ? &places_[first_] : nullptr;
  }
  void done() {
    const std::lock_guard<std::mutex> lock(mutex_);
    first_ = (first_ + 1) % places_.size();
    --waiting_;
  }

  /// Closed, and nothing waits.
  bool is_over() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return closed_ && waiting_ == 0;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<MailedImage> places_;
  std::size_t first_ = 0;
  std::size_t waiting_ = 0;
  bool closed_ = false;
  bool woken_ = false;
};

}  // namespace lsv
