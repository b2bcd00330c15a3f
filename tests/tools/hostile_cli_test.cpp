// SPDX-License-Identifier: BSD-3-Clause
// Every malformed file through the program: exit 3, one line that names the file, under 1 s,
// under 256 MB, nothing left behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/hostile_files.h"
#include "tests/support/run_program.h"

namespace lsv {
namespace {

const std::string kSamples = LSV_SOURCE_DIR "/sample_frames";

std::vector<std::string> command_for(const test::HostileFile& file, const std::string& out) {
  std::vector<std::string> args = {LSV_PROGRAM, "track", "-o", out, "-q"};
  const bool is_frames = file.role == test::HostileRole::frames;
  args.push_back(is_frames ? file.path.string() : kSamples + "/drive.tif");
  args.push_back("--calibration");
  args.push_back(file.role == test::HostileRole::calibration ? file.path.string()
                                                             : kSamples + "/calibration.toml");
  if (file.role == test::HostileRole::timestamps)
    args.insert(args.end(), {"--timestamps", file.path.string()});
  else
    args.insert(args.end(), {"--rate-hz", "1000"});
  args.insert(args.end(), file.args.begin(), file.args.end());
  return args;
}

TEST(HostileFiles, AreRefusedInOneLine) {
  const std::string folder = test::fresh_directory();
  const auto files = test::write_hostile_set(folder);
  ASSERT_GT(files.size(), 50U);
  int refused = 0;
  double longest_s = 0.0;
  double largest_mib = 0.0;
  for (const test::HostileFile& file : files) {
    if (file.valid) continue;
    SCOPED_TRACE(file.path.filename().string() + ": " + file.what);
    const std::string out = folder + "_out";
    const test::ProgramResult result = test::run_program(command_for(file, out));
    EXPECT_EQ(result.exit_code, file.bad_usage ? 2 : 3) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    const std::string culprit = file.bad_usage ? "--raw" : file.path.filename().string();
    EXPECT_NE(result.err.find(culprit), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
#ifndef LSV_SANITIZED
    EXPECT_LT(result.wall_s, 1.0);
    EXPECT_LT(result.peak_rss_mib, 256.0);
#endif
    if (std::filesystem::exists(out)) {
      EXPECT_TRUE(std::filesystem::is_empty(out)) << "something was left behind";
    }
    std::filesystem::remove_all(out);
    ++refused;
    longest_s = std::max(longest_s, result.wall_s);
    largest_mib = std::max(largest_mib, result.peak_rss_mib);
  }
  std::printf("%d hostile files refused, each within %.2f s and %.0f MiB\n", refused, longest_s,
              largest_mib);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace lsv
