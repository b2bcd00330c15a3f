// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/csv_sink.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>

#include "tests/lsv/output/track_samples.h"

namespace lsv {
namespace {

using namespace testing_samples;

std::string csv_of(const std::vector<StepReport>& reports, const RunInfo& info = sample_run(),
                   bool interrupted = false) {
  const ScratchDirectory scratch;
  CsvSink sink(opened(scratch.file("t.csv")), info);
  feed(sink, reports, interrupted);
  return text_of(scratch.file("t.csv"));
}

/// The lines after the comments, the header first.
std::vector<std::string> table_of(const std::string& csv) {
  std::vector<std::string> out;
  for (const std::string& line : split(csv, '\n'))
    if (!line.starts_with("#")) out.push_back(line);
  return out;
}

TEST(CsvSink, HeaderIsExactlyThis) {
  EXPECT_EQ(table_of(csv_of(sample_reports()))[0],
            "frame,time_s,dt_s,dx_px,dy_px,sigma_dx_px,sigma_dy_px,zncc,q,status,"
            "vx_m_s,vy_m_s,x_m,y_m,sigma_vx_m_s,sigma_vy_m_s,motion");
}

TEST(CsvSink, AnAcceptedRowIsExactlyThis) {
  EXPECT_EQ(
      table_of(csv_of(sample_reports()))[1],
      "1,0.010000000,0.010000000,1.500000,-2.250000,0.050000,0.060000,0.875000,9.5000,ok,"
      "0.100000000,-0.200000000,0.001000000,-0.002000000,0.001000000000,0.002000000000,moving");
}

TEST(CsvSink, ARefusedRowHasEmptyNumbers) {
  EXPECT_EQ(table_of(csv_of(sample_reports()))[2],
            "2,0.020000000,0.010000000,,,,,,,below_q_gate,,,,,,,");
}

TEST(CsvSink, OneRowPerFrameAfterTheFirst) {
  const std::string csv = csv_of(sample_reports());
  const std::vector<std::string> table = table_of(csv);
  ASSERT_EQ(table.size(), 1U + 4U);
  EXPECT_TRUE(table[3].starts_with("5,"));  // after a hole of two frames
  for (const std::string& line : table) EXPECT_EQ(split(line, ',').size(), 17U) << line;
  EXPECT_TRUE(csv.ends_with('\n'));
  EXPECT_EQ(csv.find('\r'), std::string::npos);
}

TEST(CsvSink, EpochStampsKeepEveryNanosecond) {
  const auto table = table_of(csv_of(sample_reports(1'700'000'000'123'456'789)));
  EXPECT_TRUE(table[1].starts_with("1,1700000000.133456789,0.010000000,")) << table[1];
}

TEST(CsvSink, NeverPrintsNanOrInfinity) {
  std::vector<StepReport> reports = sample_reports();
  reports[1].shift.cov = {-1.0, kUnknown, kUnknown};
  reports[1].shift.quality = {kUnknown, INFINITY, kUnknown, kUnknown};
  reports[1].velocity = {};
  reports[1].motion = MotionState::unknown;
  RunInfo info = sample_run();
  info.config.calibration = {};
  const std::string csv = csv_of(reports, info);
  EXPECT_EQ(table_of(csv)[1],
            "1,0.010000000,0.010000000,1.500000,-2.250000,,,,,ok,,,0.001000000,-0.002000000,,,");
  for (const std::string& line : split(csv, '\n')) {
    EXPECT_EQ(line.find("nan"), std::string::npos) << line;
    EXPECT_EQ(line.find("inf"), std::string::npos) << line;
  }
}

TEST(CsvSink, CommentsTellTheRun) {
  const std::string csv = csv_of(sample_reports());
  for (const char* line :
       {"# lsv_version: 0.1.0\n", "# source: PNG sequence\n", "# frame_width_px: 128\n",
        "# frame_height_px: 96\n", "# bit_depth: 12\n", "# time_base: 1000 Hz\n",
        "# engine: zncc\n", "# peak_fit: gaussian3\n", "# max_shift_x_px: 32\n",
        "# max_shift_y_px: 24\n", "# min_zncc: 0.25\n", "# min_q: 6\n",
        "# calibration_sha256: 00ff\n", "# pixel_pitch_x_m: 1.4e-05\n", "# sc_x_ratio: 1.985\n",
        "# sc_y_ratio: 2\n", "# noise_sd_counts: unknown\n",
        "# units: ", "# sign_convention: positive dx: the pattern moved to a larger column"}) {
    EXPECT_NE(csv.find(line), std::string::npos) << line;
  }
}

TEST(CsvSink, ANewlineInANameCannotForgeARow) {
  RunInfo info = sample_run();
  info.source_description = "a\n9,9,9,9,9,9,9,9,9,ok,9,9,9,9\r\n";
  const std::string csv = csv_of(sample_reports(), info);
  EXPECT_EQ(table_of(csv).size(), 5U);
  EXPECT_NE(csv.find("# source: a?9,9"), std::string::npos);
}

TEST(CsvSink, AnInterruptedRunSaysSoInItsLastLine) {
  EXPECT_TRUE(csv_of(sample_reports(), sample_run(), true).ends_with("\n# interrupted: true\n"));
  EXPECT_EQ(csv_of(sample_reports()).find("# interrupted"), std::string::npos);
}

TEST(CsvSink, ARunWithoutFramesStillHasItsHeader) {
  EXPECT_EQ(table_of(csv_of({})), std::vector<std::string>{std::string(kCsvHeader)});
}

TEST(CsvSink, UnfinishedLeavesNothing) {
  const ScratchDirectory scratch;
  {
    CsvSink sink(opened(scratch.file("t.csv")), sample_run());
    ASSERT_TRUE(sink.write(first_report()).ok());
  }
  EXPECT_TRUE(scratch.names().empty());
}

TEST(CsvSink, TheLocaleDoesNotMatter) {
  const std::string expected = csv_of(sample_reports());
  const char* german = std::setlocale(LC_ALL, "de_DE.UTF-8");
  const std::string csv = csv_of(sample_reports());
  std::setlocale(LC_ALL, "C");
  if (german == nullptr) GTEST_SKIP() << "the locale de_DE.UTF-8 is not installed";
  EXPECT_EQ(csv, expected);
}

}  // namespace
}  // namespace lsv
