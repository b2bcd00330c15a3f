// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the stream share: pictures of a moving pattern, rendered once, and a camera
// that delivers them on a clock of its own.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "lsv/stream/host_clock.h"
#include "lsv/stream/live_source.h"
#include "lsv/stream/stream_sink.h"
#include "tools/simulated_loop.h"

namespace lsv::test {

inline constexpr std::int64_t kPeriod_ns = 1'000'000;

inline sim::SpeckleConfig loop_camera() { return {.width_px = 64, .height_px = 64}; }

/// 24 frames there and back, up to 1.5 px a frame; rendered once for the whole program.
inline const cli::SimulatedLoop& loop() {
  static const cli::SimulatedLoop kLoop =
      cli::SimulatedLoop::render(loop_camera(), 1.5, 24).value();
  return kLoop;
}

inline TrackConfig loop_config() { return cli::loop_config(loop_camera()); }

inline LiveSourceInfo loop_info() {
  return {.description = "the test camera", .format = loop().format(), .period_ns = kPeriod_ns};
}

/// Time that passes when a test says so.
class VirtualClock {
 public:
  std::int64_t now_ns() const { return now_ns_; }
  void advance_to(std::int64_t ns) { now_ns_ = std::max(now_ns_.load(), ns); }
  MonotonicClock function() {
    return [this] { return now_ns_.load(); };
  }

 private:
  std::atomic<std::int64_t> now_ns_{1'000'000'000};
};

/// Exposure `k` of a camera that does all right, from the start of a VirtualClock on.
inline FrameLabel good_label(std::int64_t k) {
  const std::int64_t at_ns = 1'000'000'000 + (k + 1) * kPeriod_ns;
  return {.camera_id = static_cast<std::uint64_t>(k + 1),
          .camera_ns = at_ns,
          .arrival_ns = at_ns + 100'000};
}

struct Delivery {
  FrameLabel label{};
  std::int64_t picture = 0;
  std::optional<FrameFormat> format{};  // when not that of the loop: a black frame of it
};

/// Sends a list of deliveries, in order of their arrival, and moves the clock to it.
class ScriptedCamera : public LiveSource {
 public:
  ScriptedCamera(VirtualClock& clock, std::vector<Delivery> deliveries)
      : clock_(clock), info_(loop_info()), deliveries_(std::move(deliveries)) {}

  const LiveSourceInfo& info() const override { return info_; }
  Result<Grab> grab(Frame& out, FrameLabel& label, std::int64_t timeout_ns) override {
    if (next_ >= deliveries_.size()) {
      if (!error_.empty()) return Error{ErrorCode::bad_input, error_};
      return Grab::ended;
    }
    const Delivery& delivery = deliveries_[next_];
    const std::int64_t latest_ns = clock_.now_ns() + timeout_ns;
    if (delivery.label.arrival_ns > latest_ns) {
      clock_.advance_to(latest_ns);
      return Grab::nothing;
    }
    clock_.advance_to(delivery.label.arrival_ns);
    label = delivery.label;
    fill(delivery, out);
    ++next_;
    return Grab::frame;
  }
  void stop() override {}
  bool reopen() override {
    ++reopen_requests;
    return reopens;
  }
  std::int64_t restarts() const override { return 0; }

  /// Instead of coming to its end.
  void fail_at_end(std::string error) { error_ = std::move(error); }

  bool reopens = false;
  int reopen_requests = 0;

 private:
  static void fill(const Delivery& delivery, Frame& out) {
    const FrameView picture = loop().frame(delivery.picture);
    const FrameFormat format = delivery.format.value_or(picture.format);
    out.reset(format);
    const std::size_t row_bytes =
        static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
    for (int y = 0; y < format.height_px; ++y) {
      if (delivery.format)
        std::memset(out.row(y), 0, row_bytes);
      else
        std::memcpy(out.row(y), picture.row8(y), row_bytes);
    }
  }

  VirtualClock& clock_;
  LiveSourceInfo info_;
  std::vector<Delivery> deliveries_;
  std::size_t next_ = 0;
  std::string error_;
};

/// Keeps all that it is told.
struct KeepingSink : StreamSink {
  std::vector<StreamReport> reports;
  std::vector<StreamEvent> events;
  std::vector<HealthSnapshot> healths;

  void on_report(const StreamReport& report, Frame& frame) override {
    EXPECT_EQ(report.step.frame, frame.index);
    reports.push_back(report);
  }
  void on_event(const StreamEvent& event) override { events.push_back(event); }
  void on_health(const HealthSnapshot& health) override { healths.push_back(health); }

  /// Of the last event of that name.
  std::string text(const std::string& name) const {
    std::string out;
    for (const StreamEvent& event : events) out = event.name == name ? event.text : out;
    return out;
  }
  std::int64_t count(const std::string& name) const {
    return std::count_if(events.begin(), events.end(),
                         [&](const StreamEvent& event) { return event.name == name; });
  }
};

/// Invariant I1.
inline void expect_balanced(const HealthSnapshot& health) {
  std::int64_t rejected = 0;
  for (const std::int64_t count : health.rejected) rejected += count;
  EXPECT_EQ(health.received, health.processed + rejected + health.dropped + health.queued);
}

inline std::int64_t rejected(const HealthSnapshot& health, FrameRejection why) {
  for (std::size_t i = 0; i < kAllFrameRejections.size(); ++i) {
    if (kAllFrameRejections[i] == why) return health.rejected[i];
  }
  return -1;
}

}  // namespace lsv::test
