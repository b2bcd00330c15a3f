// SPDX-License-Identifier: BSD-3-Clause
// T2: nothing in a stream looks at the wall clock, so setting it can have no effect. Counted by
// taking the place of the functions that read it, for the whole program.
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <ctime>

#include "lsv/stream/paced_source.h"
#include "lsv/stream/stream.h"
#include "tests/lsv/stream/test_camera.h"

namespace {
std::atomic<long> g_wall_clock_readings{0};
}  // namespace

extern "C" {
int clock_gettime(clockid_t clock, timespec* out) noexcept {
  if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_TAI)
    ++g_wall_clock_readings;
  return static_cast<int>(syscall(SYS_clock_gettime, clock, out));
}
int gettimeofday(timeval* out, void* zone) noexcept {
  ++g_wall_clock_readings;
  return static_cast<int>(syscall(SYS_gettimeofday, out, zone));
}
time_t time(time_t* out) noexcept {
  ++g_wall_clock_readings;
  timespec now{};
  syscall(SYS_clock_gettime, CLOCK_REALTIME, &now);
  if (out != nullptr) *out = now.tv_sec;
  return now.tv_sec;
}
}

namespace lsv {
namespace {

TEST(WallClock, ReadingItIsSeen) {
  g_wall_clock_readings = 0;
  EXPECT_GT(std::chrono::system_clock::now().time_since_epoch().count(), 0);
  EXPECT_EQ(g_wall_clock_readings, 1);
}

TEST(WallClock, AStreamNeverReadsIt) {
  auto source = std::make_unique<PacedSource>(
      [](std::int64_t k) { return test::loop().frame(k); },
      PacedOptions{.period_ns = 500'000, .frames = 400, .driver_buffers = 400});
  {
    const auto stream =
        Stream::start(std::move(source), test::loop_config(), {.queue_reports = 400}).value();
    g_wall_clock_readings = 0;  // FFTW has asked how long planning took
    while (stream->next()) {
    }
    EXPECT_EQ(stream->health().received, 400);
  }
  EXPECT_EQ(g_wall_clock_readings, 0);
}

}  // namespace
}  // namespace lsv
