// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/lsv/mcap/small_recording.h"

namespace lsv {
namespace {

using mcap::Bytes;
using mcap::Compression;
using mcap::Damage;
using test::read_all;
using test::ReadBack;
using test::Said;
using test::said;
using test::small_file;

constexpr std::uint32_t kCount = 30;

/// Said in this order, perhaps with some left out.
bool is_subsequence(const std::vector<Said>& messages) {
  std::uint32_t next = 0;
  for (const Said& message : messages) {
    while (next < kCount && !(said(next) == message)) ++next;
    if (next++ == kCount) return false;
  }
  return true;
}

class McapFile : public testing::TestWithParam<Compression> {};

TEST_P(McapFile, IsReadBackAsItWasWritten) {
  const ReadBack back = read_all(small_file(kCount, GetParam()), Damage::refuse);
  EXPECT_EQ(back.error, "");
  ASSERT_EQ(back.messages.size(), kCount);
  for (std::uint32_t i = 0; i < kCount; ++i) EXPECT_EQ(back.messages[i], said(i)) << i;
  ASSERT_EQ(back.metadata.size(), 1U);
  EXPECT_EQ(back.metadata.front(), test::kNote);
  ASSERT_EQ(back.attachments.size(), 1U);
  EXPECT_EQ(back.attachments.front(), test::kMap);
  EXPECT_TRUE(back.condition.finished);
  EXPECT_GT(back.condition.chunks, 3U);
  EXPECT_EQ(back.condition.damages, 0U);
}

TEST_P(McapFile, OfAProgramWithoutCrcsIsReadToo) {
  const ReadBack back =
      read_all(test::without_crcs(small_file(kCount, GetParam())), Damage::refuse);
  EXPECT_EQ(back.error, "");
  EXPECT_EQ(back.messages.size(), kCount);
}

TEST_P(McapFile, CutAnywhereGivesABeginningOfTheMessages) {
  const Bytes whole = small_file(kCount, GetParam());
  std::size_t most = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_NE(read_all(cut, Damage::refuse).error, "") << size;
    const ReadBack back = read_all(cut, Damage::skip);
    EXPECT_EQ(back.error, "") << size;
    EXPECT_FALSE(back.condition.finished) << size;
    EXPECT_GE(back.messages.size(), most) << size;
    most = back.messages.size();
    for (std::uint32_t i = 0; i < back.messages.size(); ++i)
      ASSERT_EQ(back.messages[i], said(i)) << size;
  }
  EXPECT_EQ(most, kCount);
}

TEST_P(McapFile, AFlippedBitIsNoticedAndCostsAtMostItsChunk) {
  const Bytes whole = small_file(kCount, GetParam());
  const std::size_t chunks = read_all(whole, Damage::refuse).condition.chunks;
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    Bytes bad = whole;
    bad[at] ^= std::byte{1} << (random() % 8);
    EXPECT_NE(read_all(bad, Damage::refuse).error, "") << at;
    const ReadBack back = read_all(bad, Damage::skip);
    EXPECT_EQ(back.error, "") << at;
    EXPECT_TRUE(is_subsequence(back.messages)) << at;
    EXPECT_GE(back.condition.chunks + 1, chunks) << at;
    EXPECT_EQ(back.condition.chunks == chunks, back.messages.size() == kCount) << at;
  }
}

TEST_P(McapFile, NothingBehindTheLastChunkIsTaken) {
  Bytes unclosed;
  std::vector<Said> flushed;
  {
    test::MemoryDisk disk;
    mcap::Writer writer =
        test::write_small(disk, kCount, {.compression = GetParam()}, [](const Error&) { FAIL(); });
    unclosed = disk.bytes;
    flushed = read_all(unclosed, Damage::skip).messages;
  }
  ASSERT_GT(flushed.size(), 3U);
  ASSERT_LT(flushed.size(), kCount) << "one chunk is open";
  constexpr unsigned kSeed = 6;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  for (int round = 0; round < 200; ++round) {
    Bytes tail(random() % 600);
    // Zeros, noise, and noise that begins like a chunk.
    if (round % 3 != 0)
      std::ranges::generate(tail, [&random] { return static_cast<std::byte>(random()); });
    if (round % 3 == 2) {
      Bytes chunk(unclosed.end() - static_cast<std::ptrdiff_t>(random() % 400), unclosed.end());
      tail.insert(tail.begin(), chunk.begin(), chunk.end());
      for (std::size_t at = random() % 20; at < tail.size(); at += 20) tail[at] ^= std::byte{0x10};
    }
    Bytes file = unclosed;
    file.insert(file.end(), tail.begin(), tail.end());
    const ReadBack back = read_all(file, Damage::skip);
    EXPECT_EQ(back.error, "");
    EXPECT_EQ(back.messages, flushed) << round;
    EXPECT_FALSE(back.condition.finished);
    EXPECT_EQ(back.condition.damages > 0, !tail.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Chunks, McapFile, testing::Values(Compression::none, Compression::zstd),
                         [](const auto& each) {
                           return each.param == Compression::zstd ? "zstd" : "plain";
                         });

TEST(McapReader, TakesNoChunkOfAnotherRecording) {
  test::MemoryDisk ours;
  test::MemoryDisk theirs;
  const auto never = [](const Error&) { FAIL(); };
  const mcap::Writer writer = test::write_small(ours, kCount, {}, never);
  const mcap::Writer other = test::write_small(theirs, kCount, {}, never, "r2");
  const auto kept = read_all(ours.bytes, Damage::skip).messages;
  // What a file system may leave behind the end after a power cut: blocks of a deleted file.
  Bytes file = ours.bytes;
  file.insert(file.end(), theirs.bytes.begin(), theirs.bytes.end());
  EXPECT_EQ(read_all(file, Damage::skip).messages, kept);
}

TEST(McapReader, RefusesSizesThatCannotBe) {
  const auto with_chunk = [](std::uint64_t length, std::uint64_t plain, std::uint64_t stored) {
    Bytes file(mcap::kMagic.begin(), mcap::kMagic.end());
    mcap::ByteWriter out(file);
    out.number(static_cast<std::uint8_t>(mcap::Opcode::chunk));
    out.number(length);
    out.number(std::uint64_t{0});
    out.number(std::uint64_t{0});
    out.number(plain);
    out.number(std::uint32_t{1});
    out.text("zstd");
    out.number(stored);
    file.resize(file.size() + 100);
    out.bytes(mcap::kMagic);
    return file;
  };
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 60;
  for (const Bytes& file :
       {with_chunk(kHuge, 10, 10), with_chunk(144, kHuge, 100), with_chunk(144, 10, kHuge),
        with_chunk(144, 10, ~std::uint64_t{0} - 43), with_chunk(~std::uint64_t{0}, 10, 100)}) {
    const ReadBack back = read_all(file, Damage::refuse);
    EXPECT_NE(back.error.find("rec.mcap: at byte 8"), std::string::npos) << back.error;
    EXPECT_TRUE(read_all(file, Damage::skip).messages.empty());
  }
}

TEST(McapReader, SaysWhatIsNoMcapFileAndWhatWasNeverClosed) {
  EXPECT_NE(read_all(Bytes(100), Damage::refuse).error.find("is not an MCAP file"),
            std::string::npos);
  test::MemoryDisk disk;
  const mcap::Writer writer = test::write_small(disk, 5, {}, [](const Error&) { FAIL(); });
  const std::string error = read_all(disk.bytes, Damage::refuse).error;
  EXPECT_NE(error.find("never closed"), std::string::npos) << error;
  EXPECT_NE(error.find("lsv recover"), std::string::npos) << error;
}

TEST(McapWriter, AFullDiskCostsNothingOnceItHasSpaceAgain) {
  const Bytes whole = small_file(kCount, Compression::none);
  for (std::size_t capacity = 0; capacity < whole.size(); capacity += 7) {
    test::MemoryDisk disk;
    disk.capacity_bytes = capacity;
    disk.can_cut = capacity % 2 == 0;  // or the torn part is cut off later
    const auto free_space = [&disk](const Error&) {
      disk.capacity_bytes = std::numeric_limits<std::size_t>::max();
      disk.can_cut = true;
    };
    mcap::Writer writer = test::write_small(disk, kCount, {}, free_space);
    if (const Result<void> finished = writer.finish(); !finished) {
      free_space(finished.error());
      ASSERT_TRUE(writer.finish().ok());
    }
    EXPECT_EQ(disk.failures, 1) << capacity;
    EXPECT_EQ(disk.bytes, whole) << capacity;
  }
}

TEST(McapWriter, WhatMakeRoomPromisedCannotFail) {
  test::MemoryDisk disk;
  mcap::Writer writer = test::write_small(disk, 5, {}, [](const Error&) { FAIL(); });
  ASSERT_TRUE(writer.make_room(2, 100).ok());
  disk.capacity_bytes = 0;
  EXPECT_TRUE(writer.write({.sequence = 90}, Bytes(60)).ok());
  EXPECT_TRUE(writer.write({.sequence = 91}, Bytes(40)).ok());
  EXPECT_FALSE(writer.flush().ok());
}

TEST(McapWriter, RefusesAChannelThatItDoesNotKnow) {
  test::MemoryDisk disk;
  mcap::Writer writer = test::write_small(disk, 1, {}, [](const Error&) { FAIL(); });
  EXPECT_FALSE(writer.write({.channel = 2}, {}).ok());
}

}  // namespace
}  // namespace lsv
