// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/report_series.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/lsv/output/track_samples.h"

namespace lsv {
namespace {

using namespace testing_samples;

constexpr auto kOk = static_cast<std::size_t>(ShiftStatus::ok);
constexpr auto kDark = static_cast<std::size_t>(ShiftStatus::dark);

TEST(ReportSeries, AShortRunKeepsEveryFrame) {
  ReportSeries series;
  for (const StepReport& report : sample_reports(7)) series.add(report);
  ASSERT_EQ(series.points().size(), 5U);
  EXPECT_EQ(series.frames_per_point(), 1);
  EXPECT_EQ(series.first_ns(), 7);
  EXPECT_EQ(series.points()[1].vx_m_s.mean(), 0.1);
  EXPECT_EQ(series.points()[2].refused_q.min(), 4.5);
  EXPECT_TRUE(std::isnan(series.points()[2].q.mean()));
  EXPECT_EQ(series.points()[4].count_by_status[kDark], 1);
}

// 100003 frames: the last point is not full.
TEST(ReportSeries, ALongRunLosesNoRefusalAndNoExtreme) {
  constexpr std::int64_t kFrames = 100'003;
  constexpr std::int64_t kSpike = 77'777;
  constexpr std::int64_t kRefused = 12'345;
  ReportSeries series;
  StepReport last = first_report();
  series.add(last);
  for (std::int64_t i = 1; i < kFrames; ++i) {
    StepReport next = accepted_after(last);
    if (i == kSpike) next.velocity.vx_m_s = 5.0;
    if (i == kRefused) next = refused_after(last, ShiftStatus::dark);
    series.add(next);
    last = next;
  }

  EXPECT_EQ(series.frames_per_point(), 32);
  EXPECT_LE(series.points().size(), ReportSeries::kMaxPoints);
  EXPECT_GT(series.points().size(), ReportSeries::kMaxPoints / 2);
  std::int64_t accepted = 0;
  std::int64_t refused = 0;
  double highest = 0.0;
  std::int64_t expected_frame = 0;
  for (const ReportPoint& point : series.points()) {
    EXPECT_EQ(point.first_frame, expected_frame);
    expected_frame = point.last_frame + 1;
    accepted += point.count_by_status[kOk];
    refused += point.count_by_status[kDark];
    if (point.count_by_status[kDark] > 0) {
      EXPECT_LE(point.first_frame, kRefused);
      EXPECT_GE(point.last_frame, kRefused);
    }
    highest = std::fmax(highest, point.vx_m_s.max());
  }
  EXPECT_EQ(expected_frame, kFrames);
  EXPECT_EQ(accepted, kFrames - 2);
  EXPECT_EQ(refused, 1);
  EXPECT_EQ(highest, 5.0);
  EXPECT_EQ(series.points().back().last_position.x_m, last.position.x_m);
}

TEST(Spread, JoinsLikeOne) {
  Spread left, right;
  for (const double value : {1.0, 4.0, kUnknown}) left.add(value);
  right.add(-5.0);
  left.join(right);
  EXPECT_EQ(left.mean(), 0.0);
  EXPECT_EQ(left.min(), -5.0);
  EXPECT_EQ(left.max(), 4.0);
}

TEST(Spread, OfNothingIsUnknown) {
  Spread none, more;
  none.join(more);
  EXPECT_TRUE(std::isnan(none.mean()));
  EXPECT_TRUE(std::isnan(none.min()));
  EXPECT_TRUE(std::isnan(none.max()));
}

}  // namespace
}  // namespace lsv
