// SPDX-License-Identifier: BSD-3-Clause
// Draws the report in headless chromium where that is installed.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>

#include "lsv/output/report.h"
#include "tests/lsv/output/track_samples.h"

namespace lsv {
namespace {

using namespace testing_samples;

PlaneSnapshot sample_plane() {
  PlaneSnapshot plane{.frame = 1, .max_dx_px = 4, .max_dy_px = 3, .zncc = {}};
  plane.zncc.assign(9 * 7, 0.25F);
  plane.dx_px = 1.25;
  plane.dy_px = -0.5;
  plane.status = "ok";
  plane.engine = "zncc";
  return plane;
}

/// The exit code of tools/check_report.
int check(const std::string& path) {
  const std::string command = std::string(LSV_SOURCE_DIR "/tools/check_report '") + path + "'";
  const int code = std::system(command.c_str());
  return WIFEXITED(code) ? WEXITSTATUS(code) : -1;
}

void write_report(const std::string& path, const std::vector<StepReport>& reports) {
  RunInfo info = sample_run();
  info.source_description = "</script><script>throw 1</script>";
  ReportBuilder report(opened(path), info);
  ASSERT_TRUE(report.set_plane(sample_plane()).ok());
  report.set_preview({.frame = 1, .width_px = 2, .height_px = 1, .grey = {0, 255}});
  feed(report, reports, true);
}

TEST(ReportInBrowser, IsDrawnWithoutError) {
  const ScratchDirectory scratch;
  write_report(scratch.file("r.html"), sample_reports());
  const int code = check(scratch.file("r.html"));
  if (code == 77) GTEST_SKIP() << "chromium is not installed";
  EXPECT_EQ(code, 0);
  EXPECT_TRUE(std::filesystem::exists(scratch.file("r.png")));
}

TEST(ReportInBrowser, IsDrawnWithoutFramesToo) {
  const ScratchDirectory scratch;
  write_report(scratch.file("r.html"), {});
  const int code = check(scratch.file("r.html"));
  if (code == 77) GTEST_SKIP() << "chromium is not installed";
  EXPECT_EQ(code, 0);
}

TEST(ReportInBrowser, ABrokenPageIsNoticed) {
  const ScratchDirectory scratch;
  write_report(scratch.file("r.html"), sample_reports());
  std::string page = text_of(scratch.file("r.html"));
  const std::string key = "\"series\":";
  page.replace(page.find(key), key.size(), "\"nothing\":");
  std::ofstream(scratch.file("r.html"), std::ios::binary) << page;
  const int code = check(scratch.file("r.html"));
  if (code == 77) GTEST_SKIP() << "chromium is not installed";
  EXPECT_EQ(code, 1);
}

}  // namespace
}  // namespace lsv
