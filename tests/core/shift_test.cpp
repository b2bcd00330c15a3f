// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/shift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

namespace lsv {
namespace {

TEST(ShiftStatus, EveryValueHasItsOwnWordAndAdvice) {
  std::set<std::string> words, sentences;
  for (const ShiftStatus status : kAllShiftStatuses) {
    words.emplace(word(status));
    sentences.emplace(advice(status));
  }
  EXPECT_EQ(words.size(), kAllShiftStatuses.size());
  EXPECT_EQ(sentences.size(), kAllShiftStatuses.size());
  EXPECT_EQ(words.count("unknown"), 0U);
  EXPECT_EQ(word(ShiftStatus::ok), "ok");
}

TEST(Shift, IsUnknownUntilMeasured) {
  const Shift shift;
  EXPECT_NE(shift.status, ShiftStatus::ok);
  EXPECT_TRUE(std::isnan(shift.dx_px));
  EXPECT_TRUE(std::isnan(shift.cov.xx_px2));
  EXPECT_TRUE(std::isnan(shift.quality.zncc));
}

}  // namespace
}  // namespace lsv
