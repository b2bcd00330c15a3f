// SPDX-License-Identifier: BSD-3-Clause
// A disk that is full, slow or gone: the stream does not notice, and the recording says what it
// lacks.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <new>
#include <thread>

#include "lsv/mcap/recover.h"
#include "lsv/mcap/tail.h"
#include "tests/lsv/mcap/file_limit.h"
#include "tests/lsv/mcap/memory_sink.h"
#include "tests/lsv/mcap/scratch.h"
#include "tests/lsv/record/recorded_stream.h"

namespace lsv {
namespace {

using test::Disk;
using test::kSmallFormat;
using test::Recorded;

/// What the recorder told, from its thread to the test's.
class Alarms {
 public:
  void hear(const StreamEvent& event) {
    const std::lock_guard lock(mutex_);
    names_.push_back(event.name);
    texts_.push_back(event.text);
  }
  std::vector<std::string> names() const {
    const std::lock_guard lock(mutex_);
    return names_;
  }
  std::string last_text() const {
    const std::lock_guard lock(mutex_);
    return texts_.back();
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> names_;
  std::vector<std::string> texts_;
};

template <typename Condition>
bool eventually(Condition holds) {
  for (int i = 0; i < 20'000; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

/// Frames recorded and frames told to be lost are all frames, each once, in order.
void expect_all_accounted_for(const Recorded& back, std::int64_t count) {
  EXPECT_EQ(back.error, "");
  EXPECT_EQ(static_cast<std::int64_t>(back.frames.size()) + back.frames_lost(), count);
  std::vector<int> told(static_cast<std::size_t>(count));
  for (const test::RecordedFrame& frame : back.frames) {
    EXPECT_EQ(frame.ordinal, frame.note.index);
    ++told.at(frame.ordinal);
  }
  for (const mcap::Dropout& dropout : back.dropouts) {
    EXPECT_EQ(dropout.frames, dropout.last_frame - dropout.first_frame + 1);
    for (std::int64_t index = dropout.first_frame; index <= dropout.last_frame; ++index)
      ++told.at(static_cast<std::size_t>(index));
  }
  EXPECT_EQ(std::ranges::count(told, 1), count);
}

TEST(RecorderFaults, ADiskThatStandsStillCostsFramesAndNotTheStream) {
  Disk disk;
  RecorderOptions options{.format = kSmallFormat, .queue_frames = 4, .chunk_bytes = 40'000};
  options.flush_ns = 1;
  auto recorder = Recorder::create(options, disk.sink());
  ASSERT_TRUE(recorder.ok());
  disk.stop(true);
  Frame frame;
  test::push(*recorder.value(), 0, frame);
  disk.wait_for_a_write();
  // The recorder's thread is stuck from here on; this one must not be.
  for (std::int64_t index = 1; index < 30; ++index) test::push(*recorder.value(), index, frame);
  EXPECT_EQ(recorder.value()->frames_dropped(), 25);
  disk.stop(false);
  std::int64_t index = 30;
  ASSERT_TRUE(eventually([&] {
    const std::int64_t before = recorder.value()->frames_dropped();
    test::push(*recorder.value(), index++, frame);
    return recorder.value()->frames_dropped() == before;
  }));
  ASSERT_TRUE(recorder.value()->close().ok());
  const Recorded back = test::read_recording(mcap::memory_source("rec.mcap", disk.bytes()));
  expect_all_accounted_for(back, index);
  ASSERT_EQ(back.dropouts.size(), 1U);
  EXPECT_EQ(back.dropouts[0].first_frame, 5);
  EXPECT_EQ(back.dropouts[0].last_frame, index - 2);
  EXPECT_EQ(back.dropouts[0].last_ns - back.dropouts[0].first_ns, 1'000'000 * (index - 7));
}

TEST(RecorderFaults, FramesLostAtTheVeryEndAreToldToo) {
  Disk disk;
  RecorderOptions options{.format = kSmallFormat, .queue_frames = 4};
  options.flush_ns = 1;
  auto recorder = Recorder::create(options, disk.sink());
  ASSERT_TRUE(recorder.ok());
  disk.stop(true);
  Frame frame;
  test::push(*recorder.value(), 0, frame);
  disk.wait_for_a_write();
  for (std::int64_t index = 1; index < 10; ++index) test::push(*recorder.value(), index, frame);
  disk.stop(false);
  ASSERT_TRUE(recorder.value()->close().ok());
  expect_all_accounted_for(test::read_recording(mcap::memory_source("rec.mcap", disk.bytes())), 10);
}

TEST(RecorderFaults, EventsThatFoundNoRoomAreCounted) {
  Disk disk;
  RecorderOptions options{.format = kSmallFormat};
  options.flush_ns = 1;
  auto recorder = Recorder::create(options, disk.sink());
  ASSERT_TRUE(recorder.ok());
  disk.stop(true);
  Frame frame;
  test::push(*recorder.value(), 0, frame);
  disk.wait_for_a_write();
  for (int i = 0; i < 1100; ++i) recorder.value()->on_event(test::some_event());
  disk.stop(false);
  ASSERT_TRUE(recorder.value()->close().ok());
  const Recorded back = test::read_recording(mcap::memory_source("rec.mcap", disk.bytes()));
  EXPECT_EQ(back.count("frames_missing"), 1000);
  ASSERT_EQ(back.count("notes_lost"), 1);
  EXPECT_TRUE(back.events.back().text.starts_with("100 ")) << back.events.back().text;
}

TEST(RecorderFaults, AFullDiskIsOneAlarmAndADropoutWhenItHasSpaceAgain) {
  Disk disk;
  Alarms alarms;
  RecorderOptions options{.format = kSmallFormat, .queue_frames = 16, .chunk_bytes = 40'000};
  options.flush_ns = 1'000'000;
  options.sync_ns = 2'000'000;
  options.retry_ns = 1'000'000;
  options.alarm = [&alarms](const StreamEvent& event) { alarms.hear(event); };
  auto recorder = Recorder::create(options, disk.sink());
  ASSERT_TRUE(recorder.ok());
  Frame frame;
  std::int64_t index = 0;
  // Slowly enough for the queue, so that every loss is the disk's.
  const auto push = [&] {
    test::push(*recorder.value(), index++, frame);
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  };
  for (int i = 0; i < 50; ++i) push();
  disk.set_capacity(disk.bytes().size());
  ASSERT_TRUE(eventually([&] {
    push();
    return recorder.value()->frames_dropped() > 20 && !alarms.names().empty();
  }));
  EXPECT_EQ(alarms.names(), std::vector<std::string>{"recording_failing"});
  EXPECT_NE(alarms.last_text().find("the disk is full"), std::string::npos);
  disk.set_capacity(std::size_t{1} << 30);
  ASSERT_TRUE(eventually([&] { return alarms.names().size() == 2; }));
  EXPECT_EQ(alarms.names().back(), "recording_resumed");
  for (int i = 0; i < 50; ++i) push();
  ASSERT_TRUE(recorder.value()->close().ok());
  EXPECT_GT(disk.syncs(), 0);

  const Recorded back = test::read_recording(mcap::memory_source("rec.mcap", disk.bytes()));
  expect_all_accounted_for(back, index);
  EXPECT_EQ(back.frames_lost(), recorder.value()->frames_dropped());
  EXPECT_EQ(back.count("recording_failing"), 1);
  EXPECT_EQ(back.count("recording_resumed"), 1);
}

TEST(RecorderFaults, WhatAFullDiskDidNotTakeAtTheEndIsInTheTail) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  RecorderOptions options{.path = path, .format = kSmallFormat, .chunk_bytes = 60'000};
  options.flush_ns = 1'000'000'000'000;
  auto recorder = Recorder::create(options);
  ASSERT_TRUE(recorder.ok());
  // The tail has its space already.
  std::optional<test::FileLimit> full;
  full.emplace(test::file_bytes(path).size() + 100);
  Frame frame;
  for (std::int64_t index = 0; index < 400; ++index) test::push(*recorder.value(), index, frame);
  const Result<void> closed = recorder.value()->close();
  full.reset();
  ASSERT_FALSE(closed.ok());
  EXPECT_NE(closed.error().message.find(path), std::string::npos) << closed.error().message;
  const std::int64_t dropped = recorder.value()->frames_dropped();
  EXPECT_GT(dropped, 0);

  test::MemoryDisk disk;
  ASSERT_TRUE(mcap::recover(mcap::open_file(path).value(), mcap::open_tail(path).value(),
                            std::make_unique<test::MemorySink>(disk))
                  .ok());
  const Recorded back = test::read_recording(mcap::memory_source("rec.mcap", disk.bytes));
  EXPECT_EQ(static_cast<std::int64_t>(back.frames.size()) + dropped, 400);
  expect_all_accounted_for(back, 400);
}

/// Pushes as fast as the queue takes it; never returns. `safe` counts frames pushed.
void record_for_ever(const std::string& path, std::atomic<std::uint32_t>& pushed) {
  RecorderOptions options{.path = path, .format = kSmallFormat, .chunk_bytes = 40'000};
  options.flush_ns = 2'000'000;
  auto recorder = Recorder::create(options);
  if (!recorder) return;
  Frame frame;
  for (std::uint32_t index = 0;; ++index) {
    test::push(*recorder.value(), index, frame);
    pushed.store(index + 1);
    if (recorder.value()->frames_dropped() > 0) return;
    ::usleep(20);
  }
}

TEST(RecorderFaults, AKilledProcessLeavesWholeFramesWithoutAHole) {
  constexpr std::uint32_t kSeed = 5;
  std::uint32_t random = kSeed;
  void* const memory = ::mmap(nullptr, sizeof(std::atomic<std::uint32_t>), PROT_READ | PROT_WRITE,
                              MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  auto* const pushed = new (memory) std::atomic<std::uint32_t>(0);
  std::size_t frames = 0;
  for (int kill = 0; kill < 30; ++kill) {
    const test::Scratch scratch;
    const std::string path = scratch.file("rec.mcap");
    pushed->store(0);
    const pid_t child = ::fork();
    if (child == 0) {
      record_for_ever(path, *pushed);
      ::_exit(1);
    }
    while (pushed->load() == 0 && ::waitpid(child, nullptr, WNOHANG) == 0) ::usleep(50);
    random = random * 1664525U + 1013904223U;
    ::usleep(random % 20'000U);
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the child ended by itself";
    test::MemoryDisk disk;
    const auto report = mcap::recover(mcap::open_file(path).value(), mcap::open_tail(path).value(),
                                      std::make_unique<test::MemorySink>(disk));
    ASSERT_TRUE(report.ok()) << report.error().message;
    const Recorded back = test::read_recording(mcap::memory_source("rec.mcap", disk.bytes));
    ASSERT_EQ(back.error, "");
    for (std::uint32_t i = 0; i < back.frames.size(); ++i) {
      ASSERT_EQ(back.frames[i].note.index, i);
      ASSERT_EQ(back.frames[i].step.frame, i);
      ASSERT_EQ(back.frames[i].pixels.size(), 45U) << "a frame is there whole or not at all";
    }
    EXPECT_LE(back.frames.size(), pushed->load() + 1U);
    frames += back.frames.size();
  }
  EXPECT_GT(frames, 0U);
}

}  // namespace
}  // namespace lsv
