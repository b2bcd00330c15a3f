// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/frame_ids.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace lsv {
namespace {

void take(FrameIds& ids, std::uint64_t id) { ids.accept(id, ids.step(id)); }

TEST(FrameIds, CountFromAnyStart) {
  FrameIds ids(64, false);
  EXPECT_EQ(ids.step(77), 1);
  take(ids, 77);
  EXPECT_EQ(ids.step(78), 1);
  EXPECT_EQ(ids.step(80), 3);
  EXPECT_EQ(ids.step(77), 0);
  EXPECT_EQ(ids.step(70), -7);
}

TEST(FrameIds, GigEVisionGoesFrom65535To1) {
  FrameIds ids(16, true);
  take(ids, 65534);
  EXPECT_EQ(ids.step(65535), 1);
  EXPECT_EQ(ids.step(1), 2);
  take(ids, 1);
  EXPECT_EQ(ids.step(65535), -1);
  EXPECT_EQ(ids.step(3), 2);
  EXPECT_EQ(ids.step(0), 1) << "0 is no id there";
}

TEST(FrameIds, WrapToZeroAtEveryWidth) {
  for (const int bits : {8, 16, 32, 64}) {
    const std::uint64_t last = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    FrameIds ids(bits, false);
    take(ids, last - 1);
    EXPECT_EQ(ids.step(last), 1) << bits;
    EXPECT_EQ(ids.step(0), 2) << bits;
    take(ids, 0);
    EXPECT_EQ(ids.step(last), -1) << bits;
  }
}

TEST(FrameIds, RememberTheLast64) {
  FrameIds ids(32, false);
  for (std::uint64_t id = 100; id <= 200; id += 2) take(ids, id);
  EXPECT_TRUE(ids.seen(0));
  EXPECT_FALSE(ids.seen(-1));
  EXPECT_TRUE(ids.seen(-62));
  EXPECT_FALSE(ids.seen(-64)) << "too long ago to know";
  ids.mark(-1);
  EXPECT_TRUE(ids.seen(-1));
  take(ids, 300);
  EXPECT_TRUE(ids.seen(0));
  EXPECT_FALSE(ids.seen(-1));
}

}  // namespace
}  // namespace lsv
