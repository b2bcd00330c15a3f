// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/lsv/output/track_samples.h"

namespace lsv {
namespace {

using namespace testing_samples;
using nlohmann::json;

Summary summary_of(const std::vector<StepReport>& reports, const RunInfo& info = sample_run()) {
  SummaryBuilder builder(info);
  feed(builder, reports);
  return builder.summary();
}

// dt_ns of a refused row reaches back to the last accepted one: it must not be counted twice.
TEST(Summary, HeldTimeIsTheTimeThatPassed) {
  std::vector<StepReport> reports(11);
  for (std::int64_t i = 0; i <= 10; ++i) {
    StepReport& report = reports[static_cast<std::size_t>(i)];
    report.frame = i;
    report.stamp = {i * kNsPerS};
    report.dt_ns = i * kNsPerS;
    report.shift.status = i == 0 ? ShiftStatus::first_frame : ShiftStatus::dark;
  }
  EXPECT_DOUBLE_EQ(summary_of(reports).held_time_s, 10.0);
}

// first (0 s), ok, below_q_gate, ok at index 5, dark: each 10 ms apart, each step (1, -2) mm.
TEST(Summary, NumbersByHand) {
  const Summary summary = summary_of(sample_reports());
  EXPECT_EQ(summary.frames, 5);
  EXPECT_EQ(summary.shifts_ok, 2);
  EXPECT_EQ(summary.shifts_rejected, 2);
  ASSERT_EQ(summary.rejected.size(), 2U);
  EXPECT_EQ(summary.rejected[0], (std::pair<ShiftStatus, std::int64_t>(ShiftStatus::dark, 1)));
  EXPECT_DOUBLE_EQ(summary.rejected_share, 0.5);
  EXPECT_EQ(summary.missing_frames, 2);
  EXPECT_DOUBLE_EQ(summary.duration_s, 0.04);
  EXPECT_DOUBLE_EQ(summary.held_time_s, 0.02);
  const double step_m = std::sqrt(5.0) * 1e-3;
  EXPECT_NEAR(summary.path_length_m, 2 * step_m, 1e-15);
  EXPECT_DOUBLE_EQ(summary.end.x_m, 0.002);
  EXPECT_DOUBLE_EQ(summary.end.y_m, -0.004);
  EXPECT_DOUBLE_EQ(summary.end.sigma_y_m, 2e-5);
  EXPECT_NEAR(summary.mean_speed_m_s, step_m / 0.01, 1e-12);
  EXPECT_NEAR(summary.max_speed_m_s, std::hypot(0.1, 0.2), 1e-15);
  EXPECT_DOUBLE_EQ(summary.mean_zncc, 0.875);
  EXPECT_NEAR(summary.median_q, 9.5, 0.005 * 9.5);
  EXPECT_FALSE(summary.interrupted);
}

TEST(Summary, ReturningDoesNotShortenThePath) {
  std::vector<StepReport> reports{first_report()};
  reports.push_back(accepted_after(reports.back()));
  reports.push_back(accepted_after(reports.back()));
  reports.back().position = {};
  EXPECT_NEAR(summary_of(reports).path_length_m, 2e-3 * std::sqrt(5.0), 1e-15);
  EXPECT_EQ(summary_of(reports).end.x_m, 0.0);
}

TEST(Summary, AStepOfTheSourceIsNoHole) {
  RunInfo info = sample_run();
  info.index_step = 3;
  std::vector<StepReport> reports{first_report()};
  for (const std::int64_t frame : {3, 6, 12}) {
    reports.push_back(accepted_after(reports.back()));
    reports.back().frame = frame;
  }
  EXPECT_EQ(summary_of(reports, info).missing_frames, 1);
}

TEST(Summary, NothingMeasuredIsUnknown) {
  for (const auto& reports : {std::vector<StepReport>{}, {first_report()}}) {
    const RunInfo info = sample_run();
    const Summary summary = summary_of(reports);
    const json out = json::parse(summary_json(info, summary));
    for (const char* key :
         {"rejected_share", "mean_speed_m_s", "max_speed_m_s", "mean_zncc", "median_q"})
      EXPECT_TRUE(out[key].is_null()) << key;
    EXPECT_EQ(out["duration_s"].is_null(), reports.empty());
    EXPECT_EQ(out["end_x_m"].is_null(), reports.empty());
    const std::string text = summary_text(summary);
    EXPECT_EQ(text.find("nan"), std::string::npos) << text;
    EXPECT_EQ(text.find("inf"), std::string::npos) << text;
  }
}

TEST(Summary, JsonHoldsNumbersReasonsAndSettings) {
  const ScratchDirectory scratch;
  SummaryBuilder builder(sample_run(), opened(scratch.file("s.json")));
  feed(builder, sample_reports(), true);
  const json out = json::parse(text_of(scratch.file("s.json")));
  EXPECT_EQ(out["rejected_by_reason"], json::parse(R"({"dark":1,"below_q_gate":1})"));
  EXPECT_EQ(out["missing_frames"], 2);
  EXPECT_EQ(out["interrupted"], true);
  EXPECT_EQ(out["settings"]["calibration_sha256"], "00ff");
  EXPECT_EQ(out["settings"]["min_q"], 6.0);
  EXPECT_EQ(out["settings"]["refuse_frozen"], true);
  EXPECT_TRUE(out["settings"]["noise_sd_counts"].is_null());
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"s.json"});
}

TEST(Summary, TextFromOutsideNeedNotBeUtf8) {
  RunInfo info = sample_run();
  info.source_description = "caf\xe9 \"x\"\n";
  const json out = json::parse(summary_json(info, summary_of(sample_reports())));
  EXPECT_EQ(out["settings"]["source"], "caf\xef\xbf\xbd \"x\"\n");
}

TEST(Summary, TextForAPersonHasUnits) {
  EXPECT_EQ(summary_text(summary_of(sample_reports())),
            "frames   5, 2 missing\n"
            "shifts   2 ok, 2 rejected (50.00 %): 1 dark, 1 below_q_gate\n"
            "time     0.040 s, position held for 0.020 s\n"
            "path     4.472 mm\n"
            "end      x 2.000 mm (sigma 10.00 um), y -4.000 mm (sigma 20.00 um)\n"
            "speed    mean 223.6 mm/s, max 223.6 mm/s\n"
            "quality  mean ZNCC 0.8750, median Q 9.52\n");
}

TEST(MedianCounter, IsWithinHalfAPercent) {
  for (const double middle : {1.2, 7.7, 433.0, 1e6}) {
    MedianCounter counter;
    for (const double factor : {0.5, 0.9, 1.0, 1.7, 40.0}) counter.add(factor * middle);
    EXPECT_NEAR(counter.median() / middle, 1.0, 0.005) << middle;
  }
}

TEST(MedianCounter, TakesAnyNumber) {
  MedianCounter counter;
  for (const double value : {kUnknown, double(INFINITY), -1.0, 0.0}) counter.add(value);
  EXPECT_TRUE(std::isnan(counter.median()));
  counter.add(1e300);
  EXPECT_TRUE(std::isfinite(counter.median()));
}

}  // namespace
}  // namespace lsv
