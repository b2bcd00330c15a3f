// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/frame_ring.h"

#include <gtest/gtest.h>

#include <set>

namespace lsv {
namespace {

constexpr FrameFormat kFormat{.width_px = 16, .height_px = 4};

QueuedFrame numbered(std::int64_t index) {
  QueuedFrame out;
  out.frame = Frame(kFormat);
  out.frame.index = index;
  return out;
}

TEST(FrameRing, IsFirstInFirstOut) {
  FrameRing ring(3, kFormat);
  QueuedFrame out;
  EXPECT_FALSE(ring.pop(out));
  for (int i = 0; i < 10; ++i) {
    QueuedFrame a = numbered(2 * i);
    QueuedFrame b = numbered(2 * i + 1);
    EXPECT_FALSE(ring.push(a));
    EXPECT_FALSE(ring.push(b));
    EXPECT_EQ(ring.size(), 2);
    for (int k = 0; k < 2; ++k) {
      ASSERT_TRUE(ring.pop(out));
      EXPECT_EQ(out.frame.index, 2 * i + k);
    }
  }
  EXPECT_EQ(ring.dropped(), 0);
}

TEST(FrameRing, DropsTheOldestAndCountsIt) {
  FrameRing ring(3, kFormat);
  for (int i = 0; i < 8; ++i) {
    QueuedFrame in = numbered(i);
    EXPECT_EQ(ring.push(in), i >= 3);
  }
  EXPECT_EQ(ring.size(), 3);
  EXPECT_EQ(ring.dropped(), 5);
  QueuedFrame out;
  for (int i = 5; i < 8; ++i) {
    ASSERT_TRUE(ring.pop(out));
    EXPECT_EQ(out.frame.index, i);
  }
  QueuedFrame last = numbered(8);
  ring.push(last);
  EXPECT_EQ(ring.clear(), 1);
  EXPECT_EQ(ring.dropped(), 6);
  EXPECT_FALSE(ring.pop(out));
}

// Pixels never move: what goes round is the same few blocks of memory.
TEST(FrameRing, SwapsFramesAndKeepsTheirMemory) {
  FrameRing ring(2, kFormat);
  QueuedFrame in = numbered(0);
  QueuedFrame out = numbered(0);
  std::set<const std::byte*> blocks;
  for (int i = 0; i < 50; ++i) {
    const std::byte* const sent = in.frame.view().data;
    blocks.insert(sent);
    ring.push(in);
    EXPECT_NE(in.frame.view().data, nullptr);
    EXPECT_NE(in.frame.view().data, sent);
    ASSERT_TRUE(ring.pop(out));
    EXPECT_EQ(out.frame.view().data, sent);
  }
  EXPECT_LE(blocks.size(), 4U);
}

}  // namespace
}  // namespace lsv
