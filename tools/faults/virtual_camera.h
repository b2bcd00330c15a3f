// SPDX-License-Identifier: BSD-3-Clause
// A camera that sends what a script says, on a clock that runs only while somebody waits: an hour
// of frames takes as long as measuring them.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/stream/host_clock.h"
#include "lsv/stream/live_source.h"

namespace lsv::faults {

class VirtualClock {
 public:
  explicit VirtualClock(std::int64_t begin_ns) : now_ns_(begin_ns) {}
  std::int64_t now_ns() const { return now_ns_; }
  void advance_to(std::int64_t ns);
  /// Must not outlive the clock.
  MonotonicClock function() {
    return [this] { return now_ns_.load(); };
  }

 private:
  std::atomic<std::int64_t> now_ns_;
};

/// What happens to the pixels on their way.
using Spoil = std::function<void(Frame& frame)>;

struct Delivery {
  std::int64_t exposure = 0;            // that it truly is
  std::int64_t picture = 0;             // the exposure whose pixels it shows
  FrameLabel label{};                   // arrival_ns tells when it is sent, and no two are equal
  std::optional<FrameFormat> format{};  // black, of this format
  Spoil spoil{};
};

class VirtualCamera : public LiveSource {
 public:
  /// Pixels of an exposure; valid until the next call.
  using Pictures = std::function<FrameView(std::int64_t exposure)>;

  /// `deliveries` in the order of arrival.
  VirtualCamera(VirtualClock& clock, LiveSourceInfo info, Pictures pictures,
                std::vector<Delivery> deliveries);

  const LiveSourceInfo& info() const override { return info_; }
  Result<Grab> grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) override;
  void stop() override {}
  bool reopen() override;

  /// Instead of coming to its end it fails with this error.
  void fail_at_end(std::string error) { error_ = std::move(error); }
  /// Whether it may be opened anew on request.
  void set_reopens(bool reopens) { reopens_ = reopens; }
  int reopen_requests() const { return reopen_requests_; }

 private:
  void show(const Delivery& delivery, Frame& out);

  VirtualClock& clock_;
  LiveSourceInfo info_;
  Pictures pictures_;
  std::vector<Delivery> deliveries_;
  std::size_t next_ = 0;
  std::string error_;
  bool reopens_ = false;
  int reopen_requests_ = 0;
};

}  // namespace lsv::faults
