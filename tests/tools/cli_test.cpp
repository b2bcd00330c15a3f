// SPDX-License-Identifier: BSD-3-Clause
// The program as a user meets it: arguments, streams, exit codes, files.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/csv_table.h"
#include "tests/support/run_program.h"
#include "tests/tools/run_lsv.h"

namespace lsv {
namespace {

using test::expect_one_line_error;
using test::lsv_run;
using test::ProgramResult;
using test::read_text;

const std::string kSamples = LSV_SOURCE_DIR "/sample_frames";
const std::string kStack = kSamples + "/drive.tif";
const std::string kCalibration = kSamples + "/calibration.toml";

ProgramResult track(std::vector<std::string> args, const std::string& input = "") {
  args.insert(args.begin(), "track");
  args.insert(args.end(), {"--rate-hz", "1000", "--calibration", kCalibration});
  return lsv_run(args, input);
}

TEST(Program, EveryCommandHasHelpWithAnExample) {
  const ProgramResult help = lsv_run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const std::string command : {"track", "info", "simulate", "calibrate", "budget", "faults"})
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
  for (const std::vector<std::string>& command : {std::vector<std::string>{"track"},
                                                  {"info"},
                                                  {"simulate", "speckle"},
                                                  {"simulate", "flat"},
                                                  {"calibrate", "camera"},
                                                  {"calibrate", "geometry"},
                                                  {"budget"},
                                                  {"faults"}}) {
    std::vector<std::string> args = command;
    args.emplace_back("--help");
    const ProgramResult result = lsv_run(args);
    EXPECT_EQ(result.exit_code, 0) << command.back();
    EXPECT_NE(result.out.find("Example"), std::string::npos) << command.back();
    EXPECT_EQ(result.err, "");
  }
  EXPECT_NE(lsv_run({"--version"}).out.find("lsv "), std::string::npos);
}

TEST(Program, FaultsRunsOneAndWritesItsTable) {
  const ProgramResult unknown = lsv_run({"faults", "--only", "Z"});
  expect_one_line_error(unknown, 2, "lsv faults --list");
  const ProgramResult run =
      lsv_run({"faults", "--only", "T1", "--seeds", "1", "--exposures", "400", "--size", "64"});
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_NE(run.out.find("| T1 | "), std::string::npos);
  EXPECT_NE(run.out.find("| holds |"), std::string::npos);
}

TEST(Program, UsageErrorsAreOneLineAndExitCodeTwo) {
  expect_one_line_error(lsv_run({}), 2, "lsv --help");
  expect_one_line_error(lsv_run({"trakc"}), 2, "'trakc' is not a command");
  expect_one_line_error(lsv_run({"simulate", "spekle"}), 2, "'spekle' is not a command");
  expect_one_line_error(lsv_run({"track", "--no-such-flag", kStack}), 2, "no-such-flag");
  expect_one_line_error(track({}), 2, "no frames");
  expect_one_line_error(lsv_run({"track", kStack, "--calibration", kCalibration}), 2, "--rate-hz");
  expect_one_line_error(lsv_run({"track", kStack, "--rate-hz", "1000"}), 2, "--calibration");
  expect_one_line_error(track({kStack, "--min-q", "much"}), 2, "--min-q: 'much'");
  expect_one_line_error(track({kStack, "--max-shift", "1"}), 2, "max_shift_px");
  expect_one_line_error(track({kStack, "--max-shift", "125"}), 2, "at most 120");
  expect_one_line_error(track({kStack, "--roi", "0,0,500,20"}), 2, "128");
  expect_one_line_error(track({kStack, "--csv", "-", "--tum", "-"}), 2, "standard output");
  expect_one_line_error(lsv_run({"track", kStack, "--rate-hz", "0", "--calibration", kCalibration}),
                        2, "rate");
}

TEST(Track, WritesWhatTheReadmeSays) {
  const std::string out = test::fresh_directory() + "/new/out";
  const ProgramResult result = track({kStack, "-o", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find(" m"), std::string::npos);
  for (const char* name : {"track.csv", "track.tum", "summary.json", "report.html", "config.toml"})
    EXPECT_GT(std::filesystem::file_size(out + "/" + name), 100U) << name;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(out), {}), 5);
  const auto summary = nlohmann::json::parse(read_text(out + "/summary.json"));
  EXPECT_EQ(summary.at("frames"), 200);
  EXPECT_EQ(summary.at("shifts_ok"), 199);
}

TEST(Track, CsvHasExactlyTheHeaderThatScriptsReadByName) {
  const ProgramResult result = track({kStack, "--csv", "-", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("\nframe,time_s,dt_s,dx_px,dy_px,sigma_dx_px,sigma_dy_px,zncc,q,status,"
                            "vx_m_s,vy_m_s,x_m,y_m,sigma_vx_m_s,sigma_vy_m_s,motion\n"),
            std::string::npos);
}

TEST(Track, FollowsTheTruthOfTheSampleDrive) {
  const test::CsvTable track_rows(track({kStack, "--csv", "-", "-q"}).out);
  const test::CsvTable truth(read_text(kSamples + "/truth.csv"));
  ASSERT_EQ(track_rows.rows(), 199U);
  double x_m = 0.0;
  for (std::size_t i = 0; i < track_rows.rows(); ++i) {
    ASSERT_EQ(track_rows.text(i, "frame"), truth.text(i + 1, "frame"));
    ASSERT_EQ(track_rows.text(i, "status"), "ok");
    ASSERT_NEAR(track_rows.number(i, "dx_px"), truth.number(i + 1, "dx_px"), 0.02);
    ASSERT_NEAR(track_rows.number(i, "dy_px"), truth.number(i + 1, "dy_px"), 0.02);
    x_m += truth.number(i + 1, "dx_px") * 14e-6 / 1.985;
    ASSERT_NEAR(track_rows.number(i, "x_m"), x_m, 2e-7);
    ASSERT_NEAR(track_rows.number(i, "vx_m_s"),
                track_rows.number(i, "dx_px") * 14e-6 / (1.985 * 1e-3), 2e-8);
  }
}

// The committed replay: a change of any number shows up here and is made on purpose
// (tests/golden/README.md).
TEST(Track, ReplaysTheGoldenRunOfTheSampleFrames) {
  const test::CsvTable now(track({kStack, "--csv", "-", "-q"}).out);
  const test::CsvTable golden(read_text(LSV_SOURCE_DIR "/tests/golden/drive.csv"));
  ASSERT_EQ(now.rows(), golden.rows());
  // Another FFT, compiler or instruction set rounds differently in the seventh digit of the plane.
  const std::pair<const char*, double> tolerances[] = {
      {"dx_px", 2e-5}, {"dy_px", 2e-5}, {"sigma_dx_px", 2e-5},  {"sigma_dy_px", 2e-5},
      {"zncc", 1e-5},  {"q", 1e-2},     {"vx_m_s", 2e-7},       {"vy_m_s", 2e-7},
      {"x_m", 2e-9},   {"y_m", 2e-9},   {"sigma_vx_m_s", 2e-7}, {"sigma_vy_m_s", 2e-7}};
  for (std::size_t i = 0; i < now.rows(); ++i) {
    for (const char* exact : {"frame", "time_s", "dt_s", "status", "motion"})
      ASSERT_EQ(now.text(i, exact), golden.text(i, exact)) << "row " << i;
    for (const auto& [column, tolerance] : tolerances)
      ASSERT_NEAR(now.number(i, column), golden.number(i, column), tolerance)
          << column << " of row " << i;
  }
}

TEST(Track, StackAndPngSequenceAndRawStreamGiveTheSameRows) {
  const auto rows = [](const std::string& csv) { return csv.substr(csv.find("\nframe,")); };
  const std::string stack = rows(track({kStack, "--csv", "-", "-q"}).out);
  EXPECT_EQ(rows(track({kSamples + "/drive_png", "--csv", "-", "-q"}).out), stack);
  EXPECT_EQ(rows(track({kSamples + "/drive_png/*.png", "--csv", "-", "-q"}).out), stack);

  const std::string folder = test::fresh_directory();
  const ProgramResult made = lsv_run({"simulate", "speckle", "-o", folder + "/raw", "--format",
                                      "raw", "--frames", "6", "--size", "64x48"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  std::string stream;
  for (int i = 0; i < 6; ++i)
    stream += read_text(folder + "/raw/frame_0000" + std::to_string(i) + ".raw");
  std::ofstream(folder + "/one.raw", std::ios::binary) << stream;
  const ProgramResult piped = track({"-", "--raw", "64x48:mono8", "--csv", "-", "-q"}, stream);
  ASSERT_EQ(piped.exit_code, 0) << piped.err;
  for (const std::string input : {"/one.raw", "/raw", "/raw/*.raw"}) {
    const ProgramResult read = track({folder + input, "--raw", "64x48:mono8", "--csv", "-", "-q"});
    ASSERT_EQ(read.exit_code, 0) << read.err;
    EXPECT_EQ(rows(read.out), rows(piped.out)) << input;
  }
  expect_one_line_error(
      track({"-", "--raw", "64x48:mono8", "-q"}, stream.substr(0, stream.size() - 1)), 3,
      "frame 5");
}

TEST(Track, SameInputSameBytes) {
  const std::string folder = test::fresh_directory();
  for (const char* run : {"/a", "/b"})
    ASSERT_EQ(
        track({kStack, "-o", folder + run, "--jsonl", folder + run + "/track.jsonl"}).exit_code, 0);
  for (const char* name : {"track.csv", "track.tum", "track.jsonl", "summary.json", "report.html"})
    EXPECT_EQ(read_text(folder + "/a/" + name), read_text(folder + "/b/" + name)) << name;
}

TEST(Track, AHoleInTheNumbersIsAMissingFrame) {
  const std::string folder = test::fresh_directory();
  for (const int i : {0, 1, 2, 5, 6}) {
    char name[32];
    std::snprintf(name, sizeof name, "/frame_%05d.png", i);
    std::filesystem::copy(kSamples + "/drive_png" + name, folder + name);
  }
  const ProgramResult result = track({folder, "--csv", "-", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("missing"), std::string::npos);
  const test::CsvTable table(result.out);
  ASSERT_EQ(table.rows(), 4U);
  EXPECT_EQ(table.text(2, "frame"), "5");
  EXPECT_EQ(table.text(2, "dt_s"), "0.003000000");
  EXPECT_EQ(table.text(3, "dt_s"), "0.001000000");
}

TEST(Track, StepTakesEveryNthFrameWithItsTime) {
  const test::CsvTable table(
      track({kStack, "--start", "40", "--stop", "50", "--step", "3", "--csv", "-", "-q"}).out);
  ASSERT_EQ(table.rows(), 3U);
  EXPECT_EQ(table.text(0, "frame"), "43");
  EXPECT_EQ(table.text(0, "dt_s"), "0.003000000");
}

TEST(Track, TooManyRefusedShiftsAreExitCodeFour) {
  const std::string out = test::fresh_directory();
  const ProgramResult result = track({kStack, "-o", out, "--min-zncc", "0.99999"});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_TRUE(std::filesystem::exists(out + "/track.csv"));
  const test::CsvTable table(read_text(out + "/track.csv"));
  const std::size_t last = table.rows() - 1;
  for (const char* column : {"dx_px", "sigma_dx_px", "zncc", "q", "vx_m_s", "x_m", "y_m"})
    EXPECT_EQ(table.text(last, column), "") << column;
  EXPECT_EQ(table.text(last, "status"), "below_zncc_gate");
  EXPECT_EQ(track({kStack, "--min-zncc", "1", "--max-rejected", "1"}).exit_code, 4)
      << "a run without a single shift is never fine";
}

TEST(Track, NeverOverwritesItsInputs) {
  const std::string folder = test::fresh_directory();
  for (const char* name : {"frame_00000.png", "frame_00001.png"})
    std::filesystem::copy(kSamples + "/drive_png/" + name, folder + "/" + name);
  std::filesystem::copy(kCalibration, folder + "/calibration.toml");
  const std::string frame = folder + "/frame_00001.png";
  const std::string before = read_text(frame);
  expect_one_line_error(track({folder, "--csv", frame, "-q"}), 2, "is an input of this run");
  std::filesystem::create_symlink(frame, folder + "/link");
  expect_one_line_error(track({folder, "--tum", folder + "/link", "-q"}), 2, "is an input");
  expect_one_line_error(
      lsv_run({"track", folder, "--rate-hz", "1000", "--calibration", folder + "/calibration.toml",
               "--summary", folder + "/calibration.toml", "-q"}),
      2, "is an input");
  EXPECT_EQ(read_text(frame), before);
}

TEST(Track, AFailedRunLeavesNoNewFile) {
  const std::string folder = test::fresh_directory();
  std::filesystem::create_symlink("/dev/full", folder + "/report.html");
  EXPECT_EQ(track({kStack, "-o", folder, "-q"}).exit_code, 1);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(Track, OutOfMemoryIsOneLine) {
#ifdef LSV_SANITIZED
  GTEST_SKIP() << "AddressSanitizer needs more address space than this test leaves";
#endif
  const std::string file = test::fresh_directory() + "/large.raw";
  std::ofstream(file).close();
  std::filesystem::resize_file(file, 2 * 4096 * 4096);
  const ProgramResult result = test::run_program(
      {"/bin/sh", "-c",
       "ulimit -v 700000; exec " LSV_PROGRAM " track " + file + " --raw 4096x4096:mono8 " +
           "--rate-hz 1 -q --calibration " + kCalibration});
  expect_one_line_error(result, 2, "not enough memory");
}

TEST(Track, OneFrameIsNoTrack) {
  expect_one_line_error(track({kStack, "--stop", "1", "-q"}), 3, "at least two frames");
}

TEST(Track, AnInterruptedRunClosesItsFilesAndSaysSo) {
  const std::string folder = test::fresh_directory();
  const std::string fifo = folder + "/pipe";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    if (std::freopen(fifo.c_str(), "r", stdin) == nullptr ||
        std::freopen("/dev/null", "w", stderr) == nullptr)
      ::_exit(126);
    ::execl(LSV_PROGRAM, "lsv", "track", "-", "--raw", "128x128:mono8", "--rate-hz", "1000",
            "--calibration", kCalibration.c_str(), "-o", folder.c_str(), nullptr);
    ::_exit(127);
  }
  const ProgramResult made =
      lsv_run({"simulate", "speckle", "-o", folder + "/raw", "--format", "raw", "--frames", "4"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const int pipe = ::open(fifo.c_str(), O_WRONLY);
  ASSERT_GE(pipe, 0);
  for (int i = 0; i < 4; ++i) {
    char name[40];
    std::snprintf(name, sizeof name, "/raw/frame_%05d.raw", i);
    const std::string bytes = read_text(folder + name);
    ASSERT_EQ(::write(pipe, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  // Once it has taken all of them it waits for more.
  int unread = 1;
  while (::ioctl(pipe, FIONREAD, &unread) == 0 && unread > 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  ::close(pipe);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const std::string csv = read_text(folder + "/track.csv");
  EXPECT_NE(csv.find("# interrupted: true"), std::string::npos) << csv;
  EXPECT_EQ(test::CsvTable(csv).rows(), 3U);
}

TEST(Track, OutputThatCannotBeWrittenIsExitCodeOneAndLeavesNothing) {
  EXPECT_EQ(track({kStack, "--csv", "/dev/full", "-q"}).exit_code, 1);
  const std::string folder = test::fresh_directory();
  expect_one_line_error(track({kStack, "--csv", folder + "/no/such/dir/a.csv", "-q"}), 1, "a.csv");
}

TEST(Track, PrintConfigNamesTheSourceOfEveryValue) {
  const std::string folder = test::fresh_directory();
  const std::string file = folder + "/lsv.toml";
  std::ofstream(file) << "min_q = 7.5\nmin_zncc = 0.3\nstep = 2\nengine = \"cross\"\n";
  const ProgramResult result = lsv_run({"track", "--print-config", "--config", file, "--step", "4"},
                                       "", {"LSV_MIN_ZNCC=0.4", "LSV_STEP=3"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("min_q = 7.5  # " + file + ":1 min_q"), std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("min_zncc = 0.4  # LSV_MIN_ZNCC"), std::string::npos);
  EXPECT_NE(result.out.find("step = 4  # --step"), std::string::npos);
  EXPECT_NE(result.out.find("min_peak_ratio = 1.2  # default"), std::string::npos);
  EXPECT_NE(result.out.find("# rate_hz is not set"), std::string::npos);
}

TEST(Track, WhatPrintConfigPrintsCanBeGivenBack) {
  const std::string folder = test::fresh_directory();
  const ProgramResult first =
      lsv_run({"track", "--print-config", "--start", "007", "--min-zncc", ".5", "--min-q", "3.",
               "--timestamps", "1e3", "--roi", "0,0,64,64", "--allow-frozen"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  std::ofstream(folder + "/again.toml") << first.out;
  const ProgramResult again =
      lsv_run({"track", "--print-config", "--config", folder + "/again.toml"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const auto values = [](const std::string& toml) {
    std::string out;
    std::istringstream lines(toml);
    for (std::string line; std::getline(lines, line);)
      out += line.substr(0, line.find("  #")) + "\n";
    return out;
  };
  EXPECT_EQ(values(again.out), values(first.out));
  EXPECT_NE(again.out.find("start = 7 "), std::string::npos) << again.out;
}

TEST(Track, TheHigherSourceOfTimeCounts) {
  const std::string stamps = test::fresh_directory() + "/stamps.csv";
  std::ofstream file(stamps);
  file << "time_s\n";
  for (int i = 0; i < 200; ++i) file << i * 0.004 << "\n";
  file.close();
  const ProgramResult result = lsv_run(
      {"track", kStack, "--timestamps", stamps, "--calibration", kCalibration, "--csv", "-", "-q"},
      "", {"LSV_RATE_HZ=1000"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(test::CsvTable(result.out).text(0, "dt_s"), "0.004000000");
}

TEST(Track, UnknownVariablesAndEmptyNamesAreErrors) {
  expect_one_line_error(lsv_run({"track", kStack}, "", {"LSV_MAX_SHIFT=9"}), 2, "LSV_MAX_SHIFT");
  expect_one_line_error(track({kStack, "--csv", ""}), 2, "--csv");
  expect_one_line_error(track({kStack, "--max-rejected", "7"}), 2, "--max-rejected");
  expect_one_line_error(track({kStack, "--min-q", "nan"}), 2, "--min-q");
}

TEST(Track, ARefusedRunSaysWhatToDo) {
  const ProgramResult result = track({kStack, "--min-signal", "0.9", "-q"});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_NE(result.err.find("most often dark: The frame is dark: check the laser"),
            std::string::npos)
      << result.err;
}

TEST(Track, AWrongConfigurationNamesFileLineAndKey) {
  const std::string file = test::fresh_directory() + "/lsv.toml";
  std::ofstream(file) << "min_q = 7.5\nmin_zcnn = 0.3\n";
  expect_one_line_error(lsv_run({"track", "--print-config", "--config", file}), 3,
                        file + ":2: unknown key min_zcnn");
  std::ofstream(file) << "min_q = 7.5\n\nmin_zncc = \"high\"\n";
  expect_one_line_error(lsv_run({"track", "--print-config", "--config", file}), 3, file + ":3");
}

}  // namespace
}  // namespace lsv
