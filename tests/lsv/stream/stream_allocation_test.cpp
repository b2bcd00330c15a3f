// SPDX-License-Identifier: BSD-3-Clause
// A running stream allocates nothing: counted in the whole program, all threads.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "lsv/stream/paced_source.h"
#include "lsv/stream/stream.h"
#include "tests/lsv/stream/test_camera.h"
#include "tests/support/allocation_counter.h"

namespace lsv {
namespace {

TEST(StreamAllocation, TheCounterSeesAnotherThread) {
  test::count_allocations(true);
  std::thread([] { delete new int(3); }).join();
  test::count_allocations(false);
  EXPECT_GE(test::allocations(), 2);
}

TEST(StreamAllocation, NothingPerFrame) {
  // The queue fits all, so that there is no event about drops however slow the machine is.
  constexpr std::int64_t kFrames = 3000;
  auto source = std::make_unique<PacedSource>(
      [](std::int64_t k) { return test::loop().frame(k); },
      PacedOptions{.period_ns = 200'000, .frames = kFrames, .driver_buffers = kFrames});
  std::int64_t sum = 0;
  CallbackSink callback([&](const StreamReport& report) { sum += report.step.frame; });
  const auto stream = Stream::start(std::move(source), test::loop_config(),
                                    {.queue_frames = kFrames, .queue_reports = 16}, {&callback})
                          .value();
  while (stream->next()->step.frame < 300) {
  }
  test::count_allocations(true);
  std::int64_t last = 0;
  while (last < kFrames - 200) last = stream->next()->step.frame;
  const HealthSnapshot health = stream->health();
  test::count_allocations(false);
  EXPECT_GT(health.processed, kFrames - 300);
  EXPECT_EQ(test::allocations(), 0);
}

}  // namespace
}  // namespace lsv
