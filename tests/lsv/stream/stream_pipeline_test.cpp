// SPDX-License-Identifier: BSD-3-Clause
// Behaviour of a stream without its threads, on a clock that the test drives.
#include "lsv/stream/stream_pipeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>

#include "tests/lsv/stream/test_camera.h"

namespace lsv {
namespace {

using faults::Delivery;
using faults::VirtualClock;
using test::good_label;
using test::kPeriod_ns;

std::vector<Delivery> good_deliveries(std::int64_t exposures) {
  std::vector<Delivery> out;
  for (std::int64_t k = 0; k < exposures; ++k)
    out.push_back({.exposure = k, .picture = k, .label = good_label(k)});
  return out;
}

/// A pipeline, its clock and its listener.
struct Bench {
  VirtualClock clock{test::kBegin_ns};
  test::KeepingSink sink;
  std::unique_ptr<StreamPipeline> pipeline;

  explicit Bench(const StreamOptions& options = {}, std::vector<StreamSink*> more = {}) {
    more.push_back(&sink);
    pipeline = StreamPipeline::create(test::loop_config(), test::loop_info(), options,
                                      std::move(more), clock.function())
                   .value();
  }

  /// All there is to do now.
  void work() {
    while (pipeline->health().queued > 0) pipeline->work(0);
    pipeline->work(0);
  }
  /// Both halves in turn until the source has nothing more.
  void run(LiveSource& camera) {
    while (pipeline->capture(camera)) work();
    while (pipeline->work(0)) {
    }
  }
};

TEST(StreamPipeline, ReportsEveryFrameInOrder) {
  Bench bench;
  faults::VirtualCamera camera = test::virtual_camera(bench.clock, good_deliveries(200));
  bench.run(camera);
  ASSERT_EQ(bench.sink.reports.size(), 200U);
  for (std::size_t k = 0; k < 200; ++k) {
    const StreamReport& report = bench.sink.reports[k];
    const auto exposure = static_cast<std::int64_t>(k);
    EXPECT_EQ(report.step.frame, exposure);
    EXPECT_EQ(report.step.stamp.ns, *good_label(exposure).camera_ns);
    EXPECT_EQ(report.missing_before + report.dropped_before + report.rejected_before, 0);
    EXPECT_EQ(report.latency_ns, 0) << "no time passes here while a frame is measured";
    if (k == 0) continue;
    ASSERT_EQ(report.step.shift.status, ShiftStatus::ok);
    EXPECT_NEAR(report.step.shift.dx_px, test::loop().shift(exposure).dx_px, 0.05);
  }
  const HealthSnapshot health = bench.pipeline->health();
  test::expect_balanced(health);
  EXPECT_EQ(health.state, StreamState::ended);
  EXPECT_EQ(health.processed, 200);
  EXPECT_EQ(health.shifts_ok, 199);
  EXPECT_EQ(health.latency.count, 200);
  EXPECT_EQ(health.deadline_misses, 0);
  EXPECT_TRUE(bench.sink.events.empty());
}

// R2: a consumer that takes ten times too long, or none at all.
TEST(StreamPipeline, ASlowConsumerCostsTheOldestFramesAndNothingElse) {
  constexpr int kDepth = 8;
  Bench bench({.queue_frames = kDepth});
  faults::VirtualCamera camera = test::virtual_camera(bench.clock, good_deliveries(2000));
  std::int64_t age_max_ns = 0;
  for (int i = 0; bench.pipeline->capture(camera); ++i) {
    test::expect_balanced(bench.pipeline->health());
    if (i % 10 != 9) continue;
    const std::size_t before = bench.sink.reports.size();
    bench.pipeline->work(0);
    ASSERT_EQ(bench.sink.reports.size(), before + 1);
    age_max_ns = std::max(age_max_ns, bench.sink.reports.back().latency_ns);
  }
  while (bench.pipeline->work(0)) {
  }
  const HealthSnapshot health = bench.pipeline->health();
  test::expect_balanced(health);
  EXPECT_EQ(health.received, 2000);
  EXPECT_EQ(health.processed, 200 + kDepth - 1);
  EXPECT_LE(age_max_ns, kDepth * kPeriod_ns);
  EXPECT_LE(health.queue_age_max_s, kDepth * 1e-9 * static_cast<double>(kPeriod_ns));
  EXPECT_GT(health.deadline_misses, 0);
  // Every hole is told by the frame after it.
  std::int64_t expected = 0;
  std::int64_t dropped = 0;
  for (const StreamReport& report : bench.sink.reports) {
    EXPECT_EQ(report.step.frame, expected + report.dropped_before);
    expected = report.step.frame + 1;
    dropped += report.dropped_before;
  }
  EXPECT_EQ(dropped, health.dropped);
  EXPECT_EQ(health.missing, 0) << "what the queue drops did arrive";
  // 2 s: the first line at once, then one a second, and the rest at the end.
  EXPECT_EQ(bench.sink.count("frames_dropped"), 3);
}

// Between two reports every exposure is one of: missing, rejected, dropped.
TEST(StreamPipeline, HolesAreAccountedForByTheReportAfterThem) {
  constexpr std::uint32_t kSeed = 5;
  std::mt19937 random(kSeed);
  std::vector<Delivery> deliveries;
  std::int64_t lost = 0;
  std::int64_t damaged = 0;
  for (Delivery one : good_deliveries(1500)) {
    const bool is_inner = one.picture > 0 && one.picture < 1499;
    if (is_inner && random() % 10 == 0) {
      ++lost;
      continue;
    }
    one.label.damaged = is_inner && random() % 10 == 0;
    damaged += one.label.damaged ? 1 : 0;
    deliveries.push_back(one);
  }
  Bench bench({.queue_frames = 4});
  faults::VirtualCamera camera = test::virtual_camera(bench.clock, deliveries);
  while (bench.pipeline->capture(camera)) {
    if (random() % 4 != 0) bench.pipeline->work(0);
  }
  while (bench.pipeline->work(0)) {
  }
  const HealthSnapshot health = bench.pipeline->health();
  test::expect_balanced(health);
  EXPECT_EQ(health.missing, lost) << "seed " << kSeed;
  EXPECT_EQ(test::rejected(health, FrameRejection::damaged), damaged);
  EXPECT_GT(health.dropped, 0);
  std::int64_t next = 0;
  for (const StreamReport& report : bench.sink.reports) {
    EXPECT_EQ(report.step.frame,
              next + report.missing_before + report.dropped_before + report.rejected_before);
    next = report.step.frame + 1;
  }
  EXPECT_EQ(next, 1500);
}

TEST(StreamPipeline, SilenceIsToldOnceWithin100msAndSoIsItsEnd) {
  std::vector<Delivery> deliveries = good_deliveries(1000);
  deliveries.erase(deliveries.begin() + 100, deliveries.begin() + 600);
  Bench bench;
  faults::VirtualCamera camera = test::virtual_camera(bench.clock, deliveries);
  std::vector<StreamState> states;
  while (bench.pipeline->capture(camera)) {
    const StreamState state = bench.pipeline->health().state;
    if (states.empty() || states.back() != state) states.push_back(state);
    bench.work();
  }
  EXPECT_EQ(states, (std::vector{StreamState::running, StreamState::lost, StreamState::running}));
  ASSERT_EQ(bench.sink.count("source_lost"), 1);
  ASSERT_EQ(bench.sink.count("source_back"), 1);
  for (const StreamEvent& event : bench.sink.events) {
    const std::int64_t since_last_ns = event.host_ns - good_label(99).arrival_ns;
    if (event.name == "source_lost") {
      EXPECT_LE(since_last_ns, 91'000'000);
      EXPECT_GE(since_last_ns, 90'000'000);
    }
  }
  EXPECT_EQ(bench.sink.reports[100].missing_before, 500);
  EXPECT_EQ(bench.pipeline->health().missing, 500);
}

TEST(StreamPipeline, ASourceThatFailsDegradesTheStream) {
  Bench bench;
  faults::VirtualCamera camera = test::virtual_camera(bench.clock, good_deliveries(20));
  camera.fail_at_end("the cable was pulled");
  bench.run(camera);
  EXPECT_EQ(bench.sink.reports.size(), 20U) << "what came before is measured";
  EXPECT_EQ(bench.pipeline->health().state, StreamState::degraded);
  ASSERT_EQ(bench.sink.count("source_failed"), 1);
  EXPECT_NE(bench.sink.text("source_failed").find("the cable was pulled"), std::string::npos);
  EXPECT_EQ(bench.sink.healths.back().state, StreamState::degraded);
}

// A12: 10 frames of another format in a row, then once more after the camera was opened anew.
TEST(StreamPipeline, AnotherFormatIsRefusedAndTheCameraOpenedAnewOnce) {
  constexpr FrameFormat kOther{.width_px = 48, .height_px = 64};
  std::vector<Delivery> deliveries = good_deliveries(300);
  for (std::size_t k = 0; k < deliveries.size(); ++k) {
    if (k == 20 || (k >= 50 && k < 80) || k >= 200) deliveries[k].format = kOther;
  }
  for (const bool reopens : {true, false}) {
    Bench bench;
    faults::VirtualCamera camera = test::virtual_camera(bench.clock, deliveries);
    camera.set_reopens(reopens);
    std::vector<StreamState> states;
    while (bench.pipeline->capture(camera)) {
      const StreamState state = bench.pipeline->health().state;
      if (states.empty() || states.back() != state) states.push_back(state);
      bench.work();
    }
    EXPECT_EQ(states, (std::vector{StreamState::running, StreamState::degraded,
                                   StreamState::running, StreamState::degraded}));
    const HealthSnapshot health = bench.pipeline->health();
    test::expect_balanced(health);
    EXPECT_EQ(test::rejected(health, FrameRejection::wrong_format), 1 + 30 + 100);
    EXPECT_EQ(health.missing, 0);
    EXPECT_EQ(health.processed, 300 - 131);
    EXPECT_EQ(bench.sink.count("source_reopening"), reopens ? 2 : 0);
    EXPECT_EQ(bench.sink.count("wrong_format"), 2);
    EXPECT_EQ(camera.reopen_requests(), 2) << "once each time";
  }
}

TEST(StreamPipeline, WhatTheOdometerRefusesIsCounted) {
  const FrameFormat format{
      .width_px = 32, .height_px = 32, .type = PixelType::mono16, .bit_depth = 12};
  LiveSourceInfo info = test::loop_info();
  info.format = format;
  // Of 12 bits, and once of 13.
  struct TwelveBits : LiveSource {
    LiveSourceInfo said;
    std::int64_t next = 0;
    const LiveSourceInfo& info() const override { return said; }
    Result<Grab> grab(Frame& out, FrameLabel& label, std::int64_t) override {
      if (next == 10) return Grab::ended;
      out.reset(said.format);
      for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) out.row16(y)[x] = static_cast<std::uint16_t>(7 * x * y % 4096);
      }
      if (next == 4) out.row16(3)[3] = 4096;
      label = good_label(next++);
      return Grab::frame;
    }
    void stop() override {}
  } camera;
  camera.said = info;
  VirtualClock clock(test::kBegin_ns);
  test::KeepingSink sink;
  auto pipeline =
      StreamPipeline::create(test::loop_config(), info, {}, {&sink}, clock.function()).value();
  while (pipeline->capture(camera)) pipeline->work(0);
  while (pipeline->work(0)) {
  }
  const HealthSnapshot health = pipeline->health();
  test::expect_balanced(health);
  EXPECT_EQ(test::rejected(health, FrameRejection::refused), 1);
  ASSERT_EQ(sink.reports.size(), 9U);
  EXPECT_EQ(sink.reports[4].rejected_before, 1);
  EXPECT_EQ(sink.reports[4].step.frame, 5);
  ASSERT_EQ(sink.count("frames_rejected"), 1);
}

TEST(StreamPipeline, ASinkThatThrowsOrKeepsFramesHurtsNobody) {
  struct Throwing : StreamSink {
    void on_report(const StreamReport&, Frame&) override { throw std::runtime_error("no room"); }
    void on_event(const StreamEvent&) override { throw std::runtime_error("no room"); }
    void on_health(const HealthSnapshot&) override { throw std::runtime_error("no room"); }
  } throwing;
  struct Keeping : StreamSink {
    Frame spare{test::loop().format()};
    void on_report(const StreamReport&, Frame& frame) override { std::swap(frame, spare); }
    void on_event(const StreamEvent&) override {}
    void on_health(const HealthSnapshot&) override {}
    std::int64_t frames_dropped() const override { return 3; }
  } keeping;
  Bench bench({}, {&throwing});
  // Behind the sink that looks at the frames.
  Bench swapped;
  swapped.pipeline = StreamPipeline::create(test::loop_config(), test::loop_info(), {},
                                            {&swapped.sink, &keeping}, swapped.clock.function())
                         .value();
  for (Bench* const one : {&bench, &swapped}) {
    faults::VirtualCamera camera = test::virtual_camera(one->clock, good_deliveries(100));
    one->run(camera);
    EXPECT_EQ(one->sink.reports.size(), 100U);
    EXPECT_EQ(one->pipeline->health().shifts_ok, 99);
  }
  EXPECT_EQ(bench.sink.count("sink_failed"), 1);
  EXPECT_EQ(swapped.pipeline->health().log_dropped, 3);
}

TEST(StreamPipeline, StopMeasuresWhatWaitsForAShortTimeOnly) {
  for (const bool in_time : {true, false}) {
    Bench bench;
    faults::VirtualCamera camera = test::virtual_camera(bench.clock, good_deliveries(100));
    for (int i = 0; i < 40; ++i) ASSERT_TRUE(bench.pipeline->capture(camera));
    bench.pipeline->stop();
    EXPECT_FALSE(bench.pipeline->capture(camera));
    if (!in_time) bench.clock.advance_to(bench.clock.now_ns() + 200'000'000);
    while (bench.pipeline->work(0)) {
    }
    const HealthSnapshot health = bench.pipeline->health();
    test::expect_balanced(health);
    EXPECT_EQ(health.state, StreamState::ended);
    EXPECT_EQ(health.processed, in_time ? 40 : 0);
    EXPECT_EQ(health.dropped, in_time ? 0 : 40);
  }
}

// R10.
TEST(StreamPipeline, AWorkerThatHangsIsFlagged) {
  Bench bench;
  faults::VirtualCamera camera = test::virtual_camera(bench.clock, good_deliveries(1200));
  std::int64_t flagged_after_ns = 0;
  for (int i = 0; i < 1200; ++i) {
    ASSERT_TRUE(bench.pipeline->capture(camera));
    if (i < 100) bench.work();
    if (flagged_after_ns == 0 && bench.pipeline->health().worker_stalls > 0)
      flagged_after_ns = bench.clock.now_ns() - good_label(100).arrival_ns;
  }
  EXPECT_EQ(flagged_after_ns, 500'000'000);
  EXPECT_EQ(bench.pipeline->health().worker_stalls, 1) << "one stall is one";
  EXPECT_GT(bench.pipeline->health().since_result_s, 1.0);
  bench.work();
  EXPECT_EQ(bench.sink.count("worker_stalled"), 1);
}

TEST(StreamPipeline, HealthComesOncePerSecondEvenInSilence) {
  std::vector<Delivery> deliveries = good_deliveries(6000);
  deliveries.erase(deliveries.begin() + 2000, deliveries.begin() + 5000);
  Bench bench;
  faults::VirtualCamera camera = test::virtual_camera(bench.clock, deliveries);
  bench.run(camera);
  ASSERT_EQ(bench.sink.healths.size(), 6U + 1U) << "and one at the end";
  EXPECT_NEAR(bench.sink.healths[0].frame_rate_hz, 1000.0, 2.0);
  EXPECT_EQ(bench.sink.healths[3].frame_rate_hz, 0.0);
  EXPECT_EQ(bench.sink.healths[3].state, StreamState::lost);
  EXPECT_GT(bench.sink.healths[3].since_valid_shift_s, 1.0);
}

TEST(StreamPipeline, TheLastFrameRateIsOfAtLeastASecond) {
  // The last ten frames come late and at once; the full second ends with the first of them.
  for (const std::int64_t frames : {400, 1005, 2005}) {
    std::vector<Delivery> deliveries = good_deliveries(frames);
    for (std::int64_t k = frames - 10; k < frames; ++k) {
      deliveries[static_cast<std::size_t>(k)].label.arrival_ns =
          good_label(frames - 1).arrival_ns + 1'000 * (k - frames + 10);
    }
    Bench bench;
    faults::VirtualCamera camera = test::virtual_camera(bench.clock, deliveries);
    bench.run(camera);
    EXPECT_NEAR(bench.sink.healths.back().frame_rate_hz, 1000.0, 2.0) << frames << " frames";
  }
}

TEST(StreamPipeline, RefusesWhatCannotBe) {
  VirtualClock clock(test::kBegin_ns);
  const auto make = [&](const StreamOptions& options, const LiveSourceInfo& info) {
    return StreamPipeline::create(test::loop_config(), info, options, {}, clock.function());
  };
  const LiveSourceInfo good = test::loop_info();
  LiveSourceInfo no_period = good;
  no_period.period_ns = 0;
  LiveSourceInfo no_bits = good;
  no_bits.id_bits = 65;
  LiveSourceInfo no_pixels = good;
  no_pixels.format.width_px = 0;
  EXPECT_TRUE(make({}, good));
  EXPECT_FALSE(make({}, no_period));
  EXPECT_FALSE(make({}, no_bits));
  EXPECT_FALSE(make({}, no_pixels));
  for (const StreamOptions& wrong :
       {StreamOptions{.queue_frames = 0}, StreamOptions{.queue_frames = 65'537},
        StreamOptions{.queue_reports = -1}, StreamOptions{.lost_after_ns = 0},
        StreamOptions{.health_every_ns = -1}, StreamOptions{.fifo_priority = 99}}) {
    const auto refused = make(wrong, good);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
    EXPECT_NE(refused.error().message.find("must be"), std::string::npos);
  }
}

}  // namespace
}  // namespace lsv
