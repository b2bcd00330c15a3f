// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the stream share: pictures of a moving pattern, rendered once, and a camera
// that shows them on a clock of its own.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "lsv/stream/live_source.h"
#include "lsv/stream/stream_sink.h"
#include "tools/faults/virtual_camera.h"
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

inline constexpr std::int64_t kBegin_ns = 1'000'000'000;

/// Exposure `k` of a camera that does all right, from kBegin_ns on.
inline FrameLabel good_label(std::int64_t k) {
  const std::int64_t at_ns = kBegin_ns + (k + 1) * kPeriod_ns;
  return {.camera_id = static_cast<std::uint64_t>(k + 1),
          .camera_ns = at_ns,
          .arrival_ns = at_ns + 100'000};
}

/// Shows the loop.
inline faults::VirtualCamera virtual_camera(faults::VirtualClock& clock,
                                            std::vector<faults::Delivery> deliveries) {
  return {clock, loop_info(), [](std::int64_t k) { return loop().frame(k); },
          std::move(deliveries)};
}

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
