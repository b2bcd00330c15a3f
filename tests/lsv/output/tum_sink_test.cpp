// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/tum_sink.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lsv/output/tum_pose.h"
#include "tests/lsv/output/track_samples.h"

namespace lsv {
namespace {

using namespace testing_samples;

std::string tum_of(const std::vector<StepReport>& reports, bool interrupted = false) {
  const ScratchDirectory scratch;
  TumSink sink(opened(scratch.file("t.tum")));
  feed(sink, reports, interrupted);
  return text_of(scratch.file("t.tum"));
}

TEST(TumSink, PosesOfTheFirstAndOfAcceptedFramesOnly) {
  EXPECT_EQ(tum_of(sample_reports()),
            "0.000000000 0.000000000 0.000000000 0 0 0 0 1\n"
            "0.010000000 0.001000000 -0.002000000 0 0 0 0 1\n"
            "0.030000000 0.002000000 -0.004000000 0 0 0 0 1\n");
}

TEST(TumSink, EightColumnsAndNothingElse) {
  for (const std::string& line : split(tum_of(sample_reports(), true), '\n'))
    EXPECT_EQ(split(line, ' ').size(), 8U) << line;
}

TEST(TumSink, EpochStampsKeepEveryNanosecond) {
  EXPECT_TRUE(
      tum_of({first_report(1'700'000'000'000'000'001)}).starts_with("1700000000.000000001 "));
}

// By 240 degrees: w is below 0.
TEST(TumPose, TurnsAboutZ) {
  std::string line = "kept\n";
  append_tum_pose(line, {1'500'000'001}, 1.0, -2.0, 4.0 * std::acos(-1.0) / 3.0);
  EXPECT_EQ(line,
            "kept\n1.500000001 1.000000000 -2.000000000 0 0 0 0.866025403784 -0.500000000000\n");
}

TEST(TumSink, AnUnknownPositionWritesNoPose) {
  std::vector<StepReport> reports = sample_reports();
  reports[1].position.x_m = kUnknown;
  EXPECT_EQ(split(tum_of(reports), '\n').size(), 2U);
}

}  // namespace
}  // namespace lsv
