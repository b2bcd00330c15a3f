// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/number_text.h"

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lsv {
namespace {

std::string fixed(double value, int decimals) {
  std::string out;
  append_fixed(out, value, decimals);
  return out;
}

std::string seconds(std::int64_t time_ns) {
  std::string out;
  append_seconds(out, time_ns);
  return out;
}

TEST(NumberText, FixedHasItsDecimals) {
  EXPECT_EQ(fixed(1.5, 6), "1.500000");
  EXPECT_EQ(fixed(-0.0625, 3), "-0.062");  // to even, as IEEE rounds
  EXPECT_EQ(fixed(2.0, 0), "2");
}

TEST(NumberText, ZeroHasNoSign) {
  EXPECT_EQ(fixed(-0.0, 3), "0.000");
  EXPECT_EQ(fixed(-1e-9, 3), "0.000");
  EXPECT_EQ(fixed(-0.001, 3), "-0.001");
}

TEST(NumberText, UnknownIsEmpty) {
  EXPECT_EQ(fixed(std::nan(""), 3), "");
  EXPECT_EQ(fixed(-std::numeric_limits<double>::infinity(), 3), "");
  std::string out;
  append_shortest(out, std::nan(""));
  EXPECT_EQ(out, "");
}

TEST(NumberText, TheLargestNumberFits) {
  const std::string text = fixed(-DBL_MAX, 17);
  EXPECT_EQ(text.size(), 1U + 309U + 1U + 17U);
  EXPECT_EQ(std::stod(text), -DBL_MAX);
}

TEST(NumberText, SecondsAreExact) {
  EXPECT_EQ(seconds(0), "0.000000000");
  EXPECT_EQ(seconds(1), "0.000000001");
  EXPECT_EQ(seconds(-1), "-0.000000001");
  EXPECT_EQ(seconds(1'700'000'000'123'456'789), "1700000000.123456789");
  EXPECT_EQ(seconds(-1'500'000'000), "-1.500000000");
  EXPECT_EQ(seconds(INT64_MAX), "9223372036.854775807");
  EXPECT_EQ(seconds(INT64_MIN), "-9223372036.854775808");
}

}  // namespace
}  // namespace lsv
