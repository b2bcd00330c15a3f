// SPDX-License-Identifier: BSD-3-Clause
// lsv info and lsv simulate speckle through the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/csv_table.h"
#include "tests/support/run_program.h"
#include "tests/tools/run_lsv.h"

namespace lsv {
namespace {

using test::lsv_run;
using test::ProgramResult;
using test::read_text;

const std::string kSamples = LSV_SOURCE_DIR "/sample_frames";

ProgramResult simulate(std::vector<std::string> args) {
  args.insert(args.begin(), {"simulate", "speckle"});
  return lsv_run(args);
}

TEST(Info, SaysWhatTheSampleFramesAre) {
  const ProgramResult result =
      lsv_run({"info", kSamples + "/drive_png", "--rate-hz", "1000", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto info = nlohmann::json::parse(result.out);
  EXPECT_EQ(info.at("width_px"), 128);
  EXPECT_EQ(info.at("height_px"), 128);
  EXPECT_EQ(info.at("bit_depth"), 8);
  EXPECT_EQ(info.at("frames"), 200);
  EXPECT_EQ(info.at("missing_frames"), 0);
  EXPECT_EQ(info.at("last_stamp_ns"), 199'000'000);
  const double mean = info.at("first_frame").at("mean_counts");
  EXPECT_NEAR(mean, 63.0, 6.0);  // 60 of speckle, 3 of camera offset
  const ProgramResult words = lsv_run({"info", kSamples + "/drive.tif"});
  EXPECT_EQ(words.exit_code, 0);
  EXPECT_NE(words.out.find("128 x 128 px"), std::string::npos);
  EXPECT_NE(words.out.find("contrast"), std::string::npos);
}

TEST(Shift, OfTwoImagesAsJson) {
  const std::string folder = test::fresh_directory();
  ASSERT_EQ(
      simulate({"-o", folder + "/p.tif", "--frames", "4", "--size", "96x80", "--rate-hz", "1000",
                "--profile", "random", "--speed-px", "6", "--speed-y-px", "6", "--seed", "9"})
          .exit_code,
      0);
  const test::CsvTable truth(read_text(folder + "/truth.csv"));
  const ProgramResult pairs = lsv_run({"shift", "--pairs", folder + "/p.tif"});
  ASSERT_EQ(pairs.exit_code, 0) << pairs.err;
  std::istringstream lines(pairs.out);
  std::string line;
  for (const std::size_t later : {std::size_t{1}, std::size_t{3}}) {
    ASSERT_TRUE(std::getline(lines, line));
    const auto row = nlohmann::json::parse(line);
    EXPECT_EQ(row.at("frame_b"), later);
    EXPECT_EQ(row.at("status"), "ok");
    EXPECT_EQ(row.at("refined"), true);
    EXPECT_NEAR(row.at("dx_px"), truth.number(later, "dx_px"), 0.005);
    EXPECT_NEAR(row.at("dy_px"), truth.number(later, "dy_px"), 0.005);
    EXPECT_LT(row.at("outlier_probability"), 1e-6);
  }
  EXPECT_FALSE(std::getline(lines, line));
}

// B before A: the opposite shift, whatever the names of the files.
TEST(Shift, TheOrderGivenIsTheOrderMeant) {
  const std::string a = kSamples + "/drive_png/frame_00050.png";
  const std::string b = kSamples + "/drive_png/frame_00053.png";
  const std::string plane = test::fresh_directory() + "/plane.csv";
  const auto ab = nlohmann::json::parse(lsv_run({"shift", a, b, "--plane", plane}).out);
  const auto ba = nlohmann::json::parse(lsv_run({"shift", b, a}).out);
  ASSERT_EQ(ab.at("status"), "ok");
  EXPECT_GT(std::abs(ab.at("dx_px").get<double>()), 0.5);
  EXPECT_NEAR(ab.at("dx_px").get<double>(), -ba.at("dx_px").get<double>(), 0.005);
  EXPECT_NEAR(ab.at("dy_px").get<double>(), -ba.at("dy_px").get<double>(), 0.005);
  const test::CsvTable table(read_text(plane));
  EXPECT_EQ(table.rows(), 65U);
  EXPECT_EQ(table.number(0, "dy_px"), -32);
}

TEST(Shift, RefusesWhatIsNoPair) {
  const std::string a = kSamples + "/drive_png/frame_00000.png";
  EXPECT_EQ(lsv_run({"shift", a}).exit_code, 2);
  EXPECT_EQ(lsv_run({"shift", a, a, a}).exit_code, 2);
  EXPECT_EQ(lsv_run({"shift", "--pairs", a, a, a}).exit_code, 3);
  EXPECT_EQ(lsv_run({"shift", a, kSamples + "/none.png"}).exit_code, 3);
  EXPECT_EQ(lsv_run({"shift", "--pairs", a, a, "--plane", "p.csv"}).exit_code, 2);
}

TEST(Shift, NeverOverwritesWhatItReads) {
  const std::string folder = test::fresh_directory();
  for (const char* name : {"/frame_00000.png", "/frame_00001.png"})
    std::filesystem::copy(kSamples + "/drive_png" + name, folder + name);
  const std::string a = folder + "/frame_00000.png";
  const std::string b = folder + "/frame_00001.png";
  const std::string before = read_text(b);
  EXPECT_EQ(lsv_run({"shift", a, b, "-o", b}).exit_code, 2);
  EXPECT_EQ(lsv_run({"shift", a, b, "--plane", b}).exit_code, 2);
  EXPECT_EQ(read_text(b), before);
  EXPECT_EQ(lsv_run({"shift", a, b, "--plane", "-"}).exit_code, 2);
  EXPECT_EQ(lsv_run({"shift", a, b, "--max-rejected", "7"}).exit_code, 2);
}

// One lost file must not pair every later frame with the wrong partner.
TEST(Shift, AMissingFrameIsNoPair) {
  const std::string folder = test::fresh_directory();
  for (const char* name :
       {"/frame_00000.png", "/frame_00002.png", "/frame_00003.png", "/frame_00004.png"})
    std::filesystem::copy(kSamples + "/drive_png" + name, folder + name);
  const ProgramResult refused = lsv_run({"shift", "--pairs", folder});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("a frame is missing"), std::string::npos) << refused.err;
  EXPECT_EQ(refused.out, "");
  EXPECT_EQ(lsv_run({"shift", "--pairs", folder, "--ignore-numbers"}).exit_code, 0);
}

TEST(Shift, DeformationAndFrozenFrames) {
  const std::string a = kSamples + "/drive_png/frame_00000.png";
  const std::string b = kSamples + "/drive_png/frame_00001.png";
  const auto row = nlohmann::json::parse(lsv_run({"shift", a, b, "--deformation"}).out);
  const double rotation_rad = row.at("rotation_rad").get<double>();
  EXPECT_LT(std::abs(rotation_rad), 5.0 * row.at("sigma_rotation_rad").get<double>());
  EXPECT_TRUE(row.at("expansion_ratio").is_number());
  const ProgramResult same =
      lsv_run({"shift", a, a, "--calibration", kSamples + "/calibration.toml"});
  EXPECT_EQ(same.exit_code, 4);
  EXPECT_EQ(nlohmann::json::parse(same.out).at("status"), "frozen");
  EXPECT_EQ(lsv_run({"shift", a, a}).exit_code, 0);  // a camera without noise may repeat itself
}

TEST(Info, RefusesAsTrackDoes) {
  EXPECT_EQ(lsv_run({"info"}).exit_code, 2);
  EXPECT_EQ(lsv_run({"info", kSamples + "/nothing.png"}).exit_code, 3);
  EXPECT_EQ(lsv_run({"info", kSamples + "/truth.csv"}).exit_code, 3);
}

TEST(Simulate, SameSeedSameBytesOtherSeedOtherBytes) {
  const std::string folder = test::fresh_directory();
  for (const auto& [name, seed] : {std::pair{"/a", "7"}, {"/b", "7"}, {"/c", "8"}}) {
    const ProgramResult made =
        simulate({"-o", folder + name, "--frames", "3", "--size", "40x24", "--seed", seed});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  for (const std::string name : {"/frame_00000.png", "/frame_00002.png"}) {
    const std::string bytes = read_text(folder + "/a" + name);
    EXPECT_GT(bytes.size(), 500U);
    EXPECT_EQ(bytes, read_text(folder + "/b" + name));
    EXPECT_NE(bytes, read_text(folder + "/c" + name));
  }
}

TEST(Simulate, WhatItWritesIsTrackedBackToItsTruth) {
  const std::string folder = test::fresh_directory();
  const ProgramResult made = simulate({"-o", folder + "/new/folder/drive.tif", "--frames", "25",
                                       "--size", "120x90", "--profile", "constant", "--speed-px",
                                       "2.5", "--speed-y-px", "-1.25", "--bit-depth", "12"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const ProgramResult tracked =
      lsv_run({"track", folder + "/new/folder/drive.tif", "--bit-depth", "12", "--rate-hz", "500",
               "--calibration", kSamples + "/calibration.toml", "--csv", "-", "-q"});
  ASSERT_EQ(tracked.exit_code, 0) << tracked.err;
  const test::CsvTable rows(tracked.out);
  const test::CsvTable truth(read_text(folder + "/new/folder/truth.csv"));
  ASSERT_EQ(rows.rows() + 1, truth.rows());
  for (std::size_t i = 0; i < rows.rows(); ++i) {
    EXPECT_NEAR(truth.number(i + 1, "dx_px"), 2.5, 1e-9);
    EXPECT_NEAR(rows.number(i, "dx_px"), 2.5, 0.01);
    EXPECT_NEAR(rows.number(i, "dy_px"), -1.25, 0.01);
  }
}

TEST(Simulate, RefusesBadSettingsAndNeverOverwrites) {
  const std::string folder = test::fresh_directory();
  const std::vector<std::vector<std::string>> bad = {
      {"--frames", "0"},    {"--size", "0x10"},    {"--size", "128"},
      {"--rho", "1.5"},     {"--speckle-px", "0"}, {"--bit-depth", "9"},
      {"--exposure", "2"},  {"--rate-hz", "-1"},   {"--profile", "no-such.csv"},
      {"--noise-sd", "nan"}};
  for (const std::vector<std::string>& args : bad) {
    std::vector<std::string> all = {"-o", folder + "/x"};
    all.insert(all.end(), args.begin(), args.end());
    const ProgramResult result = simulate(all);
    EXPECT_TRUE(result.exit_code == 2 || result.exit_code == 3) << args[0] << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder + "/x/truth.csv")) << args[0];
  }
  ASSERT_EQ(simulate({"-o", folder + "/a.tif", "--frames", "2"}).exit_code, 0);
  EXPECT_EQ(simulate({"-o", folder + "/a.tif", "--frames", "2"}).exit_code, 2);
}

TEST(SampleFrames, AreWhatTheirManifestSays) {
  const ProgramResult checked = test::run_program(
      {"/bin/sh", "-c",
       "cd '" + kSamples + "' && grep -v '^#' MANIFEST | sha256sum --check --quiet"});
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
}

}  // namespace
}  // namespace lsv
