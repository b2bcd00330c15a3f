// SPDX-License-Identifier: BSD-3-Clause
// The stream with its threads. Nothing here depends on how fast the machine is: sources keep what
// is not fetched, or only what must hold at any speed is asked.
#include "lsv/stream/stream.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "lsv/stream/paced_source.h"
#include "tests/lsv/stream/test_camera.h"

namespace lsv {
namespace {

using test::KeepingSink;

constexpr std::int64_t kKeepsAll = 1'000'000;

/// Plays the loop; `fast` periods of 100 us. Nothing is lost in the driver.
std::unique_ptr<LiveSource> player(std::int64_t frames, std::int64_t period_ns = 100'000) {
  return std::make_unique<PacedSource>(
      [](std::int64_t k) { return test::loop().frame(k); },
      PacedOptions{.period_ns = period_ns, .frames = frames, .driver_buffers = kKeepsAll});
}

std::unique_ptr<Stream> start(std::unique_ptr<LiveSource> source, const StreamOptions& options,
                              std::vector<StreamSink*> sinks = {}) {
  auto stream = Stream::start(std::move(source), test::loop_config(), options, std::move(sinks));
  if (!stream) ADD_FAILURE() << stream.error().message;
  return std::move(stream).value();
}

void await_end(const Stream& stream) {
  while (!stream.finished()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(Stream, HandsOutEveryFrameUntilTheSourceEnds) {
  KeepingSink sink;
  std::atomic<int> called{0};
  CallbackSink callback([&](const StreamReport&) { ++called; });
  const auto stream =
      start(player(500), {.queue_frames = 500, .queue_reports = 500}, {&sink, &callback});
  std::int64_t k = 0;
  while (const auto report = stream->next()) {
    EXPECT_EQ(report->step.frame, k);
    EXPECT_GE(report->latency_ns, 0);
    if (k > 0) {
      ASSERT_EQ(report->step.shift.status, ShiftStatus::ok);
      EXPECT_NEAR(report->step.shift.dy_px, test::loop().shift(k).dy_px, 0.05);
    }
    ++k;
  }
  EXPECT_EQ(k, 500);
  await_end(*stream);
  stream->stop();
  EXPECT_EQ(called, 500);
  EXPECT_EQ(sink.reports.size(), 500U);
  const HealthSnapshot health = stream->health();
  test::expect_balanced(health);
  EXPECT_EQ(health.state, StreamState::ended);
  EXPECT_EQ(health.processed, 500);
  EXPECT_EQ(health.dropped + health.missing + health.reports_dropped, 0);
  EXPECT_EQ(sink.healths.back().processed, 500);
  EXPECT_FALSE(stream->next());
}

TEST(Stream, SaysWhyItCannotStart) {
  const auto refused = Stream::start(player(1), test::loop_config(), {.queue_frames = 0});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "queue_frames is 0 but must be 1 to 65536");
}

TEST(Stream, AReaderThatStopsCostsReportsOnly) {
  const auto stream = start(player(400), {.queue_frames = 400, .queue_reports = 16});
  await_end(*stream);
  const HealthSnapshot health = stream->health();
  EXPECT_EQ(health.processed, 400);
  EXPECT_EQ(health.reports_dropped, 400 - 16);
  for (std::int64_t k = 384; k < 400; ++k) EXPECT_EQ(stream->next(0)->step.frame, k);
  EXPECT_FALSE(stream->next(0));
}

TEST(Stream, WithoutAQueueOfReportsThereIsNothingToFetch) {
  const auto stream = start(player(10), {});
  EXPECT_FALSE(stream->next());
}

// R2 with real threads: what can be said at any speed of the machine.
TEST(Stream, ASlowCallbackLosesFramesAndNoneOfThemSilently) {
  std::int64_t next = 0;
  std::int64_t told = 0;
  CallbackSink slow([&](const StreamReport& report) {
    EXPECT_EQ(report.step.frame, next + report.dropped_before);
    next = report.step.frame + 1;
    told += report.dropped_before;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  const auto stream = start(player(2000), {.queue_frames = 8}, {&slow});
  await_end(*stream);
  const HealthSnapshot health = stream->health();
  test::expect_balanced(health);
  EXPECT_EQ(health.received, 2000);
  EXPECT_GT(health.dropped, 0);
  EXPECT_EQ(health.dropped, told);
  EXPECT_EQ(next, 2000) << "the newest frame is never the one that goes";
}

// I1 in every snapshot, and no counter ever falls.
TEST(Stream, HealthIsConsistentAtAnyMoment) {
  CallbackSink uneven([](const StreamReport& report) {
    if (report.step.frame % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(3));
  });
  const auto stream = start(player(4000, 50'000), {.queue_frames = 4}, {&uneven});
  std::vector<std::thread> readers;
  for (int i = 0; i < 2; ++i) {
    readers.emplace_back([&] {
      HealthSnapshot before;
      while (!stream->finished()) {
        const HealthSnapshot now = stream->health();
        test::expect_balanced(now);
        EXPECT_GE(now.received, before.received);
        EXPECT_GE(now.processed, before.processed);
        EXPECT_GE(now.dropped, before.dropped);
        EXPECT_GE(now.latency.count, before.latency.count);
        EXPECT_LE(now.queued, 4 + 1);
        before = now;
        std::this_thread::sleep_for(std::chrono::microseconds(50));
      }
    });
  }
  for (std::thread& reader : readers) reader.join();
}

// R8.
TEST(Stream, StopsAtAnyInstantWithinHalfASecond) {
  constexpr std::uint32_t kSeed = 8;
  std::mt19937 random(kSeed);
  std::chrono::steady_clock::duration longest{};
  for (int run = 0; run < 50; ++run) {
    CallbackSink slow([is_slow = run % 5 == 0](const StreamReport&) {
      if (is_slow) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    });
    // At 1 Hz every wait is one for a frame that does not come.
    const std::int64_t period_ns = run % 5 == 4 ? kNsPerS : 200'000;
    KeepingSink sink;
    const auto stream = start(player(kKeepsAll, period_ns), {}, {&slow, &sink});
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
    const auto begin = std::chrono::steady_clock::now();
    stream->stop();
    longest = std::max(longest, std::chrono::steady_clock::now() - begin);
    stream->stop();
    EXPECT_TRUE(stream->finished());
    const HealthSnapshot health = stream->health();
    test::expect_balanced(health);
    EXPECT_EQ(health.queued, 0);
    EXPECT_EQ(health.state, StreamState::ended);
    EXPECT_EQ(sink.healths.back().state, StreamState::ended) << "told as the last thing";
    EXPECT_EQ(sink.healths.back().processed, health.processed);
  }
  EXPECT_LT(longest, std::chrono::milliseconds(500)) << "seed " << kSeed;
}

TEST(Stream, AListenerMayStopIt) {
  std::unique_ptr<Stream> stream;
  std::atomic<bool> ready{false};
  CallbackSink stopping([&](const StreamReport& report) {
    if (report.step.frame == 20 && ready) stream->stop();
  });
  // The first frame comes after the test has its stream.
  stream = start(player(kKeepsAll, 2'000'000), {}, {&stopping});
  ready = true;
  await_end(*stream);
  EXPECT_GE(stream->health().processed, 21);
}

TEST(Stream, TheDestructorStopsIt) {
  KeepingSink sink;
  {
    const auto stream = start(player(kKeepsAll), {}, {&sink});
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(sink.healths.back().state, StreamState::ended);
}

#ifndef LSV_SANITIZED
std::int64_t resident_bytes() {
  FILE* const file = std::fopen("/proc/self/statm", "r");
  long total = 0;
  long resident = 0;
  const int read = std::fscanf(file, "%ld %ld", &total, &resident);
  std::fclose(file);
  return read == 2 ? resident * ::sysconf(_SC_PAGESIZE) : -1;
}

TEST(Stream, ASlowConsumerLetsNoMemoryGrow) {
  CallbackSink slow(
      [](const StreamReport&) { std::this_thread::sleep_for(std::chrono::microseconds(500)); });
  const auto stream = start(player(20'000, 50'000), {}, {&slow});
  while (stream->health().received < 4000)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const std::int64_t warm_bytes = resident_bytes();
  await_end(*stream);
  EXPECT_GT(stream->health().dropped, 0);
  EXPECT_LE(resident_bytes() - warm_bytes, 500'000);
}
#endif

/// Does `act` on a thread that may do what any user may, and no more.
template <typename Act>
void without_privilege(const Act& act) {
  constexpr std::array kLimits = {RLIMIT_RTPRIO, RLIMIT_MEMLOCK};
  std::vector<rlimit> before;
  for (const auto limit : kLimits) {
    rlimit was{};
    getrlimit(limit, &was);
    before.push_back(was);
    const rlimit none{.rlim_cur = 0, .rlim_max = was.rlim_max};
    setrlimit(limit, &none);
  }
  std::thread([&] {
    // The system call, unlike the function, changes this thread alone.
    if (::geteuid() == 0) ::syscall(SYS_setresuid, 65534, 65534, 65534);
    act();
  }).join();
  std::size_t i = 0;
  for (const auto limit : kLimits) setrlimit(limit, &before[i++]);
}

TEST(Stream, RunsWithoutThePrivilegeOfRealTimeAndSaysSo) {
  KeepingSink sink;
  without_privilege([&] {
    const auto stream =
        start(player(50), {.queue_frames = 50, .fifo_priority = 10, .lock_memory = true}, {&sink});
    await_end(*stream);
  });
  EXPECT_EQ(sink.reports.size(), 50U);
  ASSERT_EQ(sink.count("no_realtime"), 1);
#ifndef LSV_SANITIZED  // sanitizers answer mlockall() themselves
  ASSERT_EQ(sink.count("memory_not_locked"), 1);
#endif
  for (const StreamEvent& event : sink.events) EXPECT_EQ(event.severity, Severity::warning);
}

}  // namespace
}  // namespace lsv
