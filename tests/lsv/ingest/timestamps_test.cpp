// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/timestamps.h"

#include <gtest/gtest.h>

namespace lsv {
namespace {

TEST(DecimalSeconds, KeepEveryNanosecond) {
  EXPECT_EQ(ns_from_decimal_seconds("0"), 0);
  EXPECT_EQ(ns_from_decimal_seconds("12.5"), 12'500'000'000);
  EXPECT_EQ(ns_from_decimal_seconds("+.000000001"), 1);
  EXPECT_EQ(ns_from_decimal_seconds("-0.000000001"), -1);
  EXPECT_EQ(ns_from_decimal_seconds("7."), 7'000'000'000);
  // A double would end in ...936: epoch stamps have lost their nanoseconds by then.
  EXPECT_EQ(ns_from_decimal_seconds("1700000000.123456789"), 1'700'000'000'123'456'789);
}

TEST(DecimalSeconds, UnderstandExponents) {
  EXPECT_EQ(ns_from_decimal_seconds("1.000000000000000000e+00"), 1'000'000'000);
  EXPECT_EQ(ns_from_decimal_seconds("1.25E-3"), 1'250'000);
  EXPECT_EQ(ns_from_decimal_seconds("125e-2"), 1'250'000'000);
  EXPECT_EQ(ns_from_decimal_seconds("1e-9999"), 0);
  EXPECT_EQ(ns_from_decimal_seconds("0e9999"), 0);
}

TEST(DecimalSeconds, RoundBelowTheNanosecond) {
  EXPECT_EQ(ns_from_decimal_seconds("0.0000000004999"), 0);
  EXPECT_EQ(ns_from_decimal_seconds("0.0000000005"), 1);
  EXPECT_EQ(ns_from_decimal_seconds("0.30000000000000004"), 300'000'000);
  EXPECT_EQ(ns_from_decimal_seconds("0.9999999999"), 1'000'000'000);
}

TEST(DecimalSeconds, StopAtTheRange) {
  EXPECT_EQ(ns_from_decimal_seconds("4611686018.427387904"), std::int64_t{1} << 62);
  EXPECT_FALSE(ns_from_decimal_seconds("4611686018.427387905"));
  EXPECT_FALSE(ns_from_decimal_seconds("-4611686018.427387905"));
  EXPECT_FALSE(ns_from_decimal_seconds("9223372037"));
  EXPECT_FALSE(ns_from_decimal_seconds("1e300"));
  EXPECT_FALSE(ns_from_decimal_seconds(std::string(1000, '9')));
}

TEST(DecimalSeconds, RefuseWhatIsNotADecimalNumber) {
  for (const char* text : {"", ".", "-", "e5", "1e", "1e+", "1e99999", "nan", "inf", "0x10", "1,5",
                           "1 2", " 1", "--1", "1.2.3", "1e5e5"})
    EXPECT_FALSE(ns_from_decimal_seconds(text)) << text;
}

TimestampTable parsed(std::string_view text) {
  auto table = parse_timestamps(text, "t.csv");
  EXPECT_TRUE(table) << (table ? "" : table.error().message);
  return table ? std::move(table).value() : TimestampTable{};
}

std::string refusal(std::string_view text) {
  const auto table = parse_timestamps(text, "t.csv");
  EXPECT_FALSE(table) << text;
  return table ? "" : table.error().message;
}

TEST(Timestamps, FindColumnsByName) {
  const TimestampTable table = parsed("exposure_us,frame,time_s\n5,0,0.5\n5,3,1.5\n");
  EXPECT_EQ(table.stamps, (std::vector<Stamp>{{500'000'000}, {1'500'000'000}}));
  EXPECT_EQ(table.frames, (std::vector<std::int64_t>{0, 3}));
}

TEST(Timestamps, ReadNanosecondsWithoutFrames) {
  const TimestampTable table = parsed("time_ns\n-5\n1700000000123456789");
  EXPECT_EQ(table.stamps, (std::vector<Stamp>{{-5}, {1'700'000'000'123'456'789}}));
  EXPECT_TRUE(table.frames.empty());
}

TEST(Timestamps, AcceptBomCrlfCommentsAndBlankLines) {
  const TimestampTable table =
      parsed("\xEF\xBB\xBF# camera 3\r\n\r\n time_s , frame \r\n 0 , 0 \r\n# pause\r\n0.1,1\r\n");
  EXPECT_EQ(table.stamps, (std::vector<Stamp>{{0}, {100'000'000}}));
}

TEST(Timestamps, NameLineAndColumn) {
  const std::string bad_number = refusal("# x\ntime_s\n0\nsoon\n");
  EXPECT_NE(bad_number.find("t.csv, line 4"), std::string::npos) << bad_number;
  EXPECT_NE(bad_number.find("time_s"), std::string::npos) << bad_number;
  const std::string bad_frame = refusal("time_s,frame\n0,-1\n");
  EXPECT_NE(bad_frame.find("line 2: column frame"), std::string::npos) << bad_frame;
}

TEST(Timestamps, MustIncreaseStrictly) {
  EXPECT_NE(refusal("time_s\n0.1\n0.1\n").find("line 3"), std::string::npos);
  EXPECT_NE(refusal("time_s\n0.2\n0.1\n").find("line 3"), std::string::npos);
  EXPECT_NE(refusal("time_s,frame\n0,1\n1,1\n").find("line 3"), std::string::npos);
}

TEST(Timestamps, NeedAHeaderAndARow) {
  for (const char* text : {"", "\n\n", "# only a comment\n", "0.0\n0.1\n", "time_s\n", "time\n0\n",
                           "time_s,time_ns\n0,0\n", "time_s,time_s\n0,0\n"})
    EXPECT_FALSE(refusal(text).empty());
}

TEST(Timestamps, NeedTheSameColumnsInEachRow) {
  EXPECT_NE(refusal("time_s,frame\n0,0\n1\n").find("line 3"), std::string::npos);
  EXPECT_NE(refusal("time_s\n0,0\n").find("line 2"), std::string::npos);
}

}  // namespace
}  // namespace lsv
