// SPDX-License-Identifier: BSD-3-Clause
// kill -9 at random instants of a process that records as fast as it can.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <new>
#include <random>

#include "lsv/mcap/recover.h"
#include "lsv/mcap/tail.h"
#include "lsv/mcap/writer.h"
#include "tests/lsv/mcap/scratch.h"
#include "tests/lsv/mcap/small_recording.h"

namespace lsv {
namespace {

// Small, so that many of the kills hit the change from one chunk to the next.
constexpr std::size_t kChunk_bytes = 3000;
constexpr int kKills = 200;

/// How many messages the child knows to be safe.
using Counter = std::atomic<std::uint32_t>;

Counter* shared_counter() {
  void* const memory =
      ::mmap(nullptr, sizeof(Counter), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return memory == MAP_FAILED ? nullptr : new (memory) Counter(0);
}

/// Never returns unless something fails.
void record_for_ever(const std::string& path, Counter& safe) {
  auto tail = mcap::TailFile::create(mcap::tail_path(path), kChunk_bytes);
  auto sink = mcap::create_file(path);
  if (!tail || !sink) return;
  auto writer = mcap::Writer::create(std::move(sink).value(), std::move(tail).value(), {});
  if (!writer) return;
  const auto image = writer.value().add_channel(test::channel("image"));
  const auto step = writer.value().add_channel(test::channel("step"));
  if (!image || !step) return;
  for (std::uint32_t i = 0;; ++i) {
    const test::Said each = test::said(i);
    if (!writer.value()
             .write({.channel = each.topic == "image" ? image.value() : step.value(),
                     .sequence = each.sequence,
                     .log_time_ns = each.log_time_ns,
                     .publish_time_ns = each.log_time_ns},
                    mcap::bytes_of(each.payload))
             .ok())
      return;
    writer.value().commit();
    safe.store(i + 1);
  }
}

TEST(Kill, LosesNothingThatWasCommittedAtAnyInstant) {
  constexpr unsigned kSeed = 20261126;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  Counter* const safe = shared_counter();
  ASSERT_NE(safe, nullptr);
  int unacknowledged = 0;
  int from_tail = 0;
  std::uint64_t messages = 0;
  for (int kill = 0; kill < kKills; ++kill) {
    const test::Scratch scratch;
    const std::string path = scratch.file("rec.mcap");
    safe->store(0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      record_for_ever(path, *safe);
      ::_exit(1);
    }
    // From the first message on, and a random while longer.
    while (safe->load() == 0 && ::waitpid(child, nullptr, WNOHANG) == 0) ::usleep(50);
    ::usleep(static_cast<useconds_t>(random() % 4000));
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the child ended by itself";

    auto tail = mcap::open_tail(path);
    ASSERT_TRUE(tail.ok());
    test::MemoryDisk disk;
    const auto report = mcap::recover(mcap::open_file(path).value(), std::move(tail).value(),
                                      std::make_unique<test::MemorySink>(disk));
    ASSERT_TRUE(report.ok()) << report.error().message;
    const test::ReadBack back = test::read_all(disk.bytes, mcap::Damage::refuse);
    ASSERT_EQ(back.error, "");
    const std::uint32_t acknowledged = safe->load();
    ASSERT_GE(back.messages.size(), acknowledged) << "kill " << kill;
    ASSERT_LE(back.messages.size(), acknowledged + 1U) << "kill " << kill;
    for (std::uint32_t i = 0; i < back.messages.size(); ++i)
      ASSERT_EQ(back.messages[i], test::said(i)) << "kill " << kill;
    unacknowledged += back.messages.size() > acknowledged ? 1 : 0;
    from_tail += report.value().tail_messages > 0 ? 1 : 0;
    messages += back.messages.size();
  }
  std::printf(
      "%d kills: %llu messages recovered, in %d cases one that was not yet acknowledged, in "
      "%d cases some out of the tail\n",
      kKills, static_cast<unsigned long long>(messages), unacknowledged, from_tail);
  EXPECT_GT(from_tail, 0);
}

}  // namespace
}  // namespace lsv
