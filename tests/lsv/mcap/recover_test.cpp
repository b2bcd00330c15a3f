// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/recover.h"

#include <gtest/gtest.h>

#include <random>

#include "lsv/mcap/tail.h"
#include "tests/lsv/mcap/file_limit.h"
#include "tests/lsv/mcap/scratch.h"
#include "tests/lsv/mcap/small_recording.h"

namespace lsv {
namespace {

using mcap::Bytes;
using test::said;
using test::Said;

constexpr std::size_t kChunk_bytes = 400;

/// What a killed process leaves.
struct Remains {
  Bytes file;
  Bytes tail;
};

/// Killed after `count` messages were committed; `on_disk` counts those in the file.
Remains killed_after(std::uint32_t count, std::size_t* on_disk = nullptr) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  test::MemoryDisk disk;
  {
    auto tail = mcap::TailFile::create(mcap::tail_path(path), kChunk_bytes).value();
    mcap::Writer writer =
        mcap::Writer::create(std::make_unique<test::MemorySink>(disk), std::move(tail), {}).value();
    const auto image = writer.add_channel(test::channel("image")).value();
    const auto step = writer.add_channel(test::channel("step")).value();
    for (std::uint32_t i = 0; i < count; ++i) {
      const Said each = said(i);
      EXPECT_TRUE(writer
                      .write({.channel = each.topic == "image" ? image : step,
                              .sequence = each.sequence,
                              .log_time_ns = each.log_time_ns,
                              .publish_time_ns = each.log_time_ns},
                             mcap::bytes_of(each.payload))
                      .ok());
      writer.commit();
    }
  }
  if (on_disk) *on_disk = test::read_all(disk.bytes, mcap::Damage::skip).messages.size();
  return {.file = disk.bytes, .tail = test::file_bytes(mcap::tail_path(path))};
}

struct Saved {
  Result<mcap::Recovered> report = Error{};
  std::vector<Said> messages;
};

Saved recovered(const Remains& remains) {
  test::MemoryDisk disk;
  Saved out;
  out.report = mcap::recover(mcap::memory_source("rec.mcap", remains.file),
                             mcap::memory_source("rec.mcap.tail", remains.tail),
                             std::make_unique<test::MemorySink>(disk));
  if (!out.report) return out;
  const test::ReadBack back = test::read_all(disk.bytes, mcap::Damage::refuse);
  EXPECT_EQ(back.error, "") << "what is recovered is a clean file";
  out.messages = back.messages;
  return out;
}

void expect_beginning(const std::vector<Said>& messages) {
  for (std::uint32_t i = 0; i < messages.size(); ++i) ASSERT_EQ(messages[i], said(i));
}

TEST(Recover, LosesNothingThatWasCommitted) {
  for (std::uint32_t count = 1; count < 40; ++count) {
    std::size_t on_disk = 0;
    const Saved saved = recovered(killed_after(count, &on_disk));
    ASSERT_TRUE(saved.report.ok()) << saved.report.error().message;
    EXPECT_EQ(saved.messages.size(), count);
    expect_beginning(saved.messages);
    EXPECT_EQ(saved.report.value().tail_messages, count - on_disk);
    EXPECT_FALSE(saved.report.value().file.finished);
  }
}

/// Every byte of magic, slots and records, and a few of the space between.
std::size_t step_in_tail(std::size_t at) {
  for (const std::size_t gap_end : {1020U, 2044U, 4090U}) {
    if (at >= gap_end - 990 && at + 100 < gap_end) return 100;
  }
  return 1;
}

TEST(Recover, TakesNothingCorruptOutOfATail) {
  constexpr std::uint32_t kCount = 11;
  std::size_t on_disk = 0;
  const Remains remains = killed_after(kCount, &on_disk);
  ASSERT_LT(on_disk + 1, kCount) << "the tail holds more than one message";
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  for (std::size_t at = 0; at < remains.tail.size(); at += step_in_tail(at)) {
    Remains bad = remains;
    bad.tail[at] ^= std::byte{1} << (random() % 8);
    const Saved saved = recovered(bad);
    ASSERT_TRUE(saved.report.ok());
    expect_beginning(saved.messages);
    EXPECT_GE(saved.messages.size(), on_disk);
    EXPECT_EQ(saved.report.value().tail_refused.empty(), saved.messages.size() > on_disk);
  }
  for (std::size_t size = 0; size < remains.tail.size(); size += step_in_tail(size)) {
    Remains cut = remains;
    cut.tail.resize(size);
    const Saved saved = recovered(cut);
    ASSERT_TRUE(saved.report.ok());
    expect_beginning(saved.messages);
  }
}

TEST(Recover, ATornCommitCostsOneMessage) {
  constexpr std::uint32_t kCount = 11;
  Remains remains = killed_after(kCount);
  // Commits alternate between the slots, so that of an odd number went to the first.
  for (std::size_t byte = 0; byte < 8; ++byte) remains.tail[1024 + 16 + byte] = std::byte{0xFF};
  EXPECT_EQ(recovered(remains).messages.size(), kCount - 1);
}

TEST(Recover, MendsAFileWhoseLastChunkIsTornWithTheTailThatStillHasIt) {
  // Killed inside of the write of a chunk: the tail still holds it.
  std::size_t before = 0;
  std::uint32_t count = 2;
  Remains remains = killed_after(1, &before);
  for (;; ++count) {
    std::size_t on_disk = 0;
    Remains next = killed_after(count, &on_disk);
    if (on_disk > before) {
      // `remains` has in its tail what `next` has in its file.
      for (std::size_t torn = remains.file.size(); torn < next.file.size(); torn += 11) {
        Remains half = remains;
        half.file.assign(next.file.begin(), next.file.begin() + static_cast<std::ptrdiff_t>(torn));
        const Saved saved = recovered(half);
        ASSERT_TRUE(saved.report.ok());
        EXPECT_EQ(saved.messages.size(), count - 1) << torn;
        expect_beginning(saved.messages);
      }
      return;
    }
    remains = next;
  }
}

TEST(Recover, LeavesATailOfAnotherRecordingAlone) {
  const Remains remains = killed_after(30);
  test::MemoryDisk other;
  const mcap::Writer writer = test::write_small(
      other, 30, {}, [](const Error&) { FAIL(); }, "r2");
  const auto kept = test::read_all(other.bytes, mcap::Damage::skip).messages;
  const Saved saved = recovered({.file = other.bytes, .tail = remains.tail});
  ASSERT_TRUE(saved.report.ok());
  EXPECT_EQ(saved.messages, kept);
  EXPECT_NE(saved.report.value().tail_refused, "");
  EXPECT_TRUE(saved.report.value().end_unknown);
}

TEST(Recover, KnowsTheEndOnlyByAWholeTail) {
  Remains remains = killed_after(30);
  EXPECT_FALSE(recovered(remains).report.value().end_unknown);
  Remains damaged = remains;
  damaged.tail.resize(4096);
  EXPECT_TRUE(recovered(damaged).report.value().end_unknown);
  test::MemoryDisk disk;
  const auto report = mcap::recover(mcap::memory_source("rec.mcap", remains.file), nullptr,
                                    std::make_unique<test::MemorySink>(disk));
  EXPECT_TRUE(report.value().end_unknown);
  EXPECT_FALSE(report.value().lost_something());
  // Closed well, a file needs no tail.
  test::MemoryDisk copy;
  const auto closed = mcap::recover(mcap::memory_source("rec.mcap", disk.bytes), nullptr,
                                    std::make_unique<test::MemorySink>(copy));
  EXPECT_FALSE(closed.value().end_unknown);
}

TEST(Recover, LeavesATailAloneThatTheFileHasOutgrown) {
  std::size_t on_disk = 0;
  Remains remains = killed_after(30, &on_disk);
  remains.tail = killed_after(2).tail;
  EXPECT_EQ(recovered(remains).messages.size(), on_disk);
}

TEST(Recover, ADamagedChunkIsNotMadeUpForByTheTailOfTheLast) {
  // The last chunk is in the file and in the tail; another one is damaged.
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  test::MemoryDisk disk;
  {
    mcap::Writer writer =
        mcap::Writer::create(std::make_unique<test::MemorySink>(disk),
                             mcap::TailFile::create(mcap::tail_path(path), kChunk_bytes).value(),
                             {})
            .value();
    const auto channel = writer.add_channel(test::channel("image")).value();
    for (std::uint32_t i = 0; i < 3; ++i) {
      ASSERT_TRUE(writer.write({.channel = channel, .sequence = i}, Bytes(60)).ok());
      ASSERT_TRUE(writer.flush().ok());
    }
  }
  disk.bytes[disk.bytes.size() / 2] ^= std::byte{1};
  const Saved saved =
      recovered({.file = disk.bytes, .tail = test::file_bytes(mcap::tail_path(path))});
  ASSERT_TRUE(saved.report.ok());
  ASSERT_EQ(saved.messages.size(), 2U);
  EXPECT_EQ(saved.messages[0].sequence, 0U);
  EXPECT_EQ(saved.messages[1].sequence, 2U);
  EXPECT_EQ(saved.report.value().file.damages, 1U);
}

TEST(Recover, SaysThatThereIsNothing) {
  const Saved saved = recovered({.file = Bytes(5000), .tail = {}});
  ASSERT_FALSE(saved.report.ok());
  EXPECT_NE(saved.report.error().message.find("rec.mcap"), std::string::npos);
}

TEST(TailFile, IsNotOverwrittenAndSaysWhatToDo) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap.tail");
  ASSERT_TRUE(mcap::TailFile::create(path, 100).ok());
  const auto again = mcap::TailFile::create(path, 100);
  ASSERT_FALSE(again.ok());
  EXPECT_NE(again.error().message.find("lsv recover"), std::string::npos);
}

TEST(FileSink, KeepsAnExistingFile) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  test::write_bytes(path, Bytes(3));
  EXPECT_FALSE(mcap::create_file(path).ok());
  EXPECT_EQ(test::file_bytes(path).size(), 3U);
}

TEST(FileSink, ReportsAWriteThatIsCutShortAndCutsItOff) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  auto sink = mcap::create_file(path).value();
  ASSERT_TRUE(sink->append(Bytes(900)).ok());
  {
    const test::FileLimit limit(1000);
    const Result<void> written = sink->append(Bytes(200, std::byte{1}));
    ASSERT_FALSE(written.ok());
    EXPECT_NE(written.error().message.find(path), std::string::npos);
    EXPECT_EQ(test::file_bytes(path).size(), 1000U) << "the system took a part";
    EXPECT_TRUE(sink->truncate(900).ok());
  }
  EXPECT_TRUE(sink->append(Bytes(200, std::byte{2})).ok());
  Bytes expected(900);
  expected.resize(1100, std::byte{2});
  EXPECT_EQ(test::file_bytes(path), expected);
}

TEST(FileSink, ReportsAFullDevice) {
  // A new file cannot be made there, so this only shows that the error of the system arrives.
  const auto sink = mcap::create_file("/dev/full");
  ASSERT_FALSE(sink.ok());
  EXPECT_NE(sink.error().message.find("/dev/full"), std::string::npos);
}

}  // namespace
}  // namespace lsv
