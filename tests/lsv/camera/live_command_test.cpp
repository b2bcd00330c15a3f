// SPDX-License-Identifier: BSD-3-Clause
// `lsv live` on `lsv simulate camera`, both as processes: what comes out is held against the truth,
// frame by frame. Whatever a busy machine loses must be counted; nothing may be wrong.
// LSV_LIVE_SECONDS, LSV_LIVE_RATE_HZ: longer and faster runs by hand, for docs/performance.md.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "lsv/ingest/csv_table.h"
#include "tests/lsv/mcap/file_limit.h"
#include "tests/support/own_network.h"
#include "tests/support/run_program.h"
#include "tests/support/simulated_camera_process.h"

namespace lsv {
namespace {

using nlohmann::json;
using test::SentRow;
using test::SimulatedCameraProcess;

constexpr double kTolerance_px = 0.02;
constexpr std::int64_t kNsPerS = 1'000'000'000;

std::string setting(const char* variable, const char* otherwise) {
  const char* const value = std::getenv(variable);
  return value != nullptr ? value : otherwise;
}

std::int64_t ns_of(std::string_view seconds) {
  // Nine decimals, more digits than a double holds.
  std::string digits(seconds);
  digits.erase(digits.find('.'), 1);
  return std::stoll(digits);
}

struct Comparison {
  std::int64_t rows = 0;
  std::int64_t accepted = 0;
  std::int64_t refused = 0;
  std::int64_t unknown = 0;  // rows whose stamp, or that of the frame before, is of no frame sent
  std::int64_t clocks = 0;   // of the camera: one more each time that it was opened anew
  std::int64_t first_frame_ns = 0;
  std::int64_t last_frame_ns = 0;
  std::int64_t last_index = 0;
  double largest_error_px = 0.0;
  double sum_of_squares_px2 = 0.0;

  void add_error(double error_px) {
    ++accepted;
    largest_error_px = std::max(largest_error_px, error_px);
    sum_of_squares_px2 += error_px * error_px;
  }
};

/// Which frame sent each of `stamps_ns` is. The stamps are those of the camera, until it is opened
/// anew; from then on they are a constant off, which is found by the jitter of the stamps.
class SentByStamp {
 public:
  SentByStamp(const SimulatedCameraProcess& camera, std::vector<std::int64_t> stamps_ns)
      : sent_(camera.sent()), stamps_ns_(std::move(stamps_ns)) {}

  const SentRow* find(std::size_t index) {
    const std::int64_t stamp_ns = stamps_ns_[index];
    if (!sent_.contains(stamp_ns - off_ns_) && !find_clock(index)) return nullptr;
    return &sent_.at(stamp_ns - off_ns_);
  }
  std::int64_t clocks() const { return clocks_; }

 private:
  bool find_clock(std::size_t index) {
    constexpr std::int64_t kFarthest_ns = kNsPerS / 2;
    const std::int64_t stamp_ns = stamps_ns_[index];
    for (auto candidate = sent_.lower_bound(stamp_ns - kFarthest_ns);
         candidate != sent_.end() && candidate->first < stamp_ns + kFarthest_ns; ++candidate) {
      if (!fits(index, stamp_ns - candidate->first)) continue;
      off_ns_ = stamp_ns - candidate->first;
      ++clocks_;
      return true;
    }
    return false;
  }
  bool fits(std::size_t index, std::int64_t off_ns) const {
    constexpr std::size_t kEnough = 10;
    const std::size_t end = std::min(stamps_ns_.size(), index + kEnough);
    for (std::size_t i = index; i < end; ++i) {
      if (!sent_.contains(stamps_ns_[i] - off_ns)) return false;
    }
    return true;
  }

  const std::map<std::int64_t, SentRow>& sent_;
  std::vector<std::int64_t> stamps_ns_;
  std::int64_t off_ns_ = 0;
  std::int64_t clocks_ = 1;
};

/// Every accepted shift of `track_csv` against the positions sent at its two stamps.
Comparison compare(const std::string& track_csv, const SimulatedCameraProcess& camera) {
  Comparison out;
  const auto table = CsvTable::read(track_csv);
  if (!table) {
    ADD_FAILURE() << table.error().message;
    return out;
  }
  const CsvTable& track = table.value();
  const auto column = [&](const char* name) { return track.column(name).value(); };
  const auto cell_ns = [&](std::size_t row, const char* name) {
    return ns_of(track.text(row, column(name)));
  };
  if (track.rows() == 0) return out;
  std::vector<std::int64_t> stamps_ns = {cell_ns(0, "time_s") - cell_ns(0, "dt_s")};
  for (std::size_t row = 0; row < track.rows(); ++row) stamps_ns.push_back(cell_ns(row, "time_s"));
  SentByStamp sent(camera, stamps_ns);
  out.first_frame_ns = stamps_ns.front();  // it has no row
  std::map<std::int64_t, const SentRow*> by_stamp;
  by_stamp[out.first_frame_ns] = sent.find(0);
  for (std::size_t row = 0; row < track.rows(); ++row) {
    const std::int64_t stamp_ns = stamps_ns[row + 1];
    const std::int64_t before_ns = stamp_ns - cell_ns(row, "dt_s");
    const SentRow* const now = by_stamp[stamp_ns] = sent.find(row + 1);
    ++out.rows;
    out.last_frame_ns = stamp_ns;
    out.last_index = std::llround(track.number(row, column("frame")).value());
    if (track.text(row, column("status")) != "ok") {
      ++out.refused;
      continue;
    }
    const SentRow* const before = by_stamp[before_ns];
    if (now == nullptr || before == nullptr) {
      ++out.unknown;
      continue;
    }
    const double dx_px = track.number(row, column("dx_px")).value();
    const double dy_px = track.number(row, column("dy_px")).value();
    const double error_px =
        std::hypot(dx_px - (now->x_px - before->x_px), dy_px - (now->y_px - before->y_px));
    EXPECT_LT(error_px, kTolerance_px) << "at " << stamp_ns << ", flagged valid";
    out.add_error(error_px);
  }
  out.clocks = sent.clocks();
  return out;
}

std::int64_t count(const json& health, const char* name) {
  return health.at(name).get<std::int64_t>();
}

/// What was received is what the books say, and nothing that was not sent.
void expect_balanced(const json& health, const SimulatedCameraProcess& camera,
                     const Comparison& rows) {
  std::int64_t rejected = 0;
  for (const auto& [reason, frames] : health.at("rejected").items())
    rejected += frames.get<std::int64_t>();
  EXPECT_EQ(count(health, "received"), count(health, "processed") + rejected +
                                           count(health, "dropped") + count(health, "queued"));
  // The first frame has no row.
  EXPECT_EQ(count(health, "processed"), 1 + rows.rows + count(health, "reports_dropped"));
  EXPECT_LE(count(health, "received"), static_cast<std::int64_t>(camera.sent().size()));
}

/// Every exposure from the first frame to the last, by the clock of the camera, was received or
/// counted missing; and so was every frame sent in that time.
void expect_complete(const json& health, const SimulatedCameraProcess& camera,
                     const Comparison& rows, double rate_hz) {
  const std::int64_t exposures =
      1 +
      std::llround(static_cast<double>(rows.last_frame_ns - rows.first_frame_ns) * 1e-9 * rate_hz);
  EXPECT_EQ(exposures, 1 + rows.last_index);
  EXPECT_EQ(exposures, count(health, "received") + count(health, "missing"));
  const auto sent = std::distance(camera.sent().find(rows.first_frame_ns),
                                  camera.sent().upper_bound(rows.last_frame_ns));
  EXPECT_LE(count(health, "received"), sent);
  EXPECT_LE(sent, exposures);
  std::printf("between first and last frame: %lld sent, %lld exposures\n",
              static_cast<long long>(sent), static_cast<long long>(exposures));
}

std::string calibration() {
  return std::string(LSV_SOURCE_DIR) + "/sample_frames/calibration.toml";
}

class LiveCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    // For lsv itself, as in uninstrumented.cpp.
    ::setenv("TSAN_OPTIONS", "ignore_noninstrumented_modules=1", 0);
    if (const std::string why = test::enter_own_network(); !why.empty())
      std::printf("shared loopback, %s\n", why.c_str());
  }
};

#define START_CAMERA(camera, ...)                                                 \
  SimulatedCameraProcess camera(LSV_SIMULATOR, __VA_ARGS__);                      \
  if (!(camera).is_ready()) {                                                     \
    ASSERT_NE((camera).messages().find("no camera can be at"), std::string::npos) \
        << (camera).messages();                                                   \
    GTEST_SKIP() << (camera).messages();                                          \
  }                                                                               \
  static_assert(true)

TEST_F(LiveCommand, WhatComesOutIsTheTruth) {
  const std::string rate_hz = setting("LSV_LIVE_RATE_HZ", "250");
  START_CAMERA(camera, {"--rate-hz", rate_hz, "--profile", "drive", "--speed-px", "3",
                        "--speed-y-px", "1", "--loop-frames", "200"});
  const std::string out = std::filesystem::path(camera.truth_path()).parent_path().string();
  const test::ProgramResult live = test::run_program(
      {LSV_PROGRAM, "live", "genicam:127.0.0.1", "--calibration", calibration(), "--seconds",
       setting("LSV_LIVE_SECONDS", "2.5"), "-o", out + "/out", "--health", out + "/health.json"});
  camera.finish();
  ASSERT_EQ(live.exit_code, 0) << live.err;
  EXPECT_NE(live.err.find("lsv: GenICam camera Aravis Fake LSV01 at 127.0.0.1, 128 x 128 px, "),
            std::string::npos)
      << live.err;
  const Comparison rows = compare(out + "/out/track.csv", camera);
  const json health = json::parse(test::read_text(out + "/health.json"));
  EXPECT_GT(rows.accepted, 100);
  EXPECT_EQ(rows.refused, 0) << live.err;
  expect_balanced(health, camera, rows);

  EXPECT_EQ(rows.clocks, 1);
  EXPECT_EQ(rows.unknown, 0);
  expect_complete(health, camera, rows, std::stod(rate_hz));

  std::printf("%s Hz: %zu sent (%s), %s\n%lld accepted, largest error %.5f px, rms %.5f px\n",
              rate_hz.c_str(), camera.sent().size(), json::parse(camera.printed()).dump().c_str(),
              health.dump().c_str(), static_cast<long long>(rows.accepted), rows.largest_error_px,
              std::sqrt(rows.sum_of_squares_px2 / static_cast<double>(rows.accepted)));
  for (const char* const name :
       {"track.csv", "track.tum", "summary.json", "report.html", "config.toml"})
    EXPECT_TRUE(std::filesystem::exists(out + "/out/" + name)) << name;
}

TEST_F(LiveCommand, TroubleIsCountedAndNothingWrongIsFlaggedValid) {
  START_CAMERA(camera, {"--rate-hz", "250", "--profile", "drive", "--speed-px", "2",
                        "--loop-frames", "100", "--packet-loss", "10", "--jitter-us", "500",
                        "--unplug-after-s", "1", "--unplug-for-s", "0.8", "--seed", "5"});
  const std::string out = std::filesystem::path(camera.truth_path()).parent_path().string();
  const test::ProgramResult live = test::run_program(
      {LSV_PROGRAM, "live", "genicam:127.0.0.1", "--calibration", calibration(), "--seconds", "4",
       "--csv", out + "/track.csv", "--health", out + "/health.json", "--max-rejected", "1"});
  camera.finish();
  ASSERT_EQ(live.exit_code, 0) << live.err;
  const json health = json::parse(test::read_text(out + "/health.json"));
  const Comparison rows = compare(out + "/track.csv", camera);
  std::printf("%s\n%lld accepted, %lld refused, largest error %.5f px\n", health.dump().c_str(),
              static_cast<long long>(rows.accepted), static_cast<long long>(rows.refused),
              rows.largest_error_px);
  EXPECT_GT(rows.accepted, 100) << live.err;
  expect_balanced(health, camera, rows);
  EXPECT_GT(health.at("rejected").at("damaged"), 0);
  EXPECT_GT(health.at("missing"), 0);
  EXPECT_GE(health.at("restarts"), 1) << live.err;
  EXPECT_GE(rows.clocks, 2);
  // A replaced stamp is that of no frame, and the row after it begins there.
  EXPECT_LE(rows.unknown, 2 * count(health, "bad_stamps"));
  EXPECT_NE(live.err.find("source_lost"), std::string::npos) << live.err;
  EXPECT_NE(live.err.find("source_back"), std::string::npos) << live.err;
}

TEST_F(LiveCommand, ARecordingReplaysToTheSameBytes) {
  START_CAMERA(camera, {"--rate-hz", "250", "--profile", "drive", "--speed-px", "2", "--speed-y-px",
                        "1", "--loop-frames", "200", "--packet-loss", "5"});
  const std::string out = std::filesystem::path(camera.truth_path()).parent_path().string();
  const std::string recording = out + "/drive.mcap";
  const test::ProgramResult recorded = test::run_program(
      {LSV_PROGRAM, "record", "genicam:127.0.0.1", recording, "--calibration", calibration(),
       "--seconds", "2", "-o", out + "/live", "--max-rejected", "1"});
  camera.finish();
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_FALSE(std::filesystem::exists(recording + ".tail"));
  const test::ProgramResult replayed =
      test::run_program({LSV_PROGRAM, "replay", recording, "-o", out + "/replayed"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  // The lines above the table name the source.
  const auto table = [&](const char* folder) {
    const std::string text = test::read_text(out + folder + "/track.csv");
    return text.substr(text.rfind("\n# "));
  };
  const std::string rows = table("/live");
  EXPECT_GT(std::count(rows.begin(), rows.end(), '\n'), 50);
  EXPECT_EQ(rows, table("/replayed"));
}

TEST_F(LiveCommand, AnInterruptLeavesCompleteFilesSoon) {
  START_CAMERA(camera, {"--rate-hz", "250", "--loop-frames", "50"});
  const std::string out = std::filesystem::path(camera.truth_path()).parent_path().string();
  const std::string program = LSV_PROGRAM;
  const std::string csv = out + "/track.csv";
  const std::string with = calibration();
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl(program.c_str(), program.c_str(), "live", "genicam:127.0.0.1", "--calibration",
            with.c_str(), "--csv", csv.c_str(), "--quiet", nullptr);
    ::_exit(127);
  }
  const auto begun = std::chrono::steady_clock::now();
  while (!std::filesystem::exists(csv + ".part") &&
         std::chrono::steady_clock::now() - begun < std::chrono::seconds(60))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto asked = std::chrono::steady_clock::now();
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  const double took_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - asked).count();
  camera.finish();
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_LT(took_s, 3.0);
  std::printf("stopped after %.3f s\n", took_s);
  EXPECT_GT(compare(csv, camera).rows, 0);
}

TEST_F(LiveCommand, ACameraThatStaysAwayIsGivenUpAndTheFilesAreComplete) {
  START_CAMERA(camera, {"--rate-hz", "250", "--loop-frames", "50", "--unplug-after-s", "1"});
  const std::string out = std::filesystem::path(camera.truth_path()).parent_path().string();
  const test::ProgramResult live =
      test::run_program({LSV_PROGRAM, "live", "genicam:127.0.0.1", "--calibration", calibration(),
                         "--csv", out + "/track.csv", "--seconds", "60", "--reopen-attempts", "2"});
  camera.finish();
  EXPECT_EQ(live.exit_code, 3) << live.err;
  EXPECT_LT(live.wall_s, 40.0);
  EXPECT_NE(live.err.find("no camera answers at 127.0.0.1"), std::string::npos) << live.err;
  EXPECT_GT(compare(out + "/track.csv", camera).rows, 0);
}

TEST_F(LiveCommand, UsageIsRefusedInOneLine) {
  const auto refusal = [](std::vector<std::string> args, int exit_code) {
    args.insert(args.begin(), {LSV_PROGRAM, "live"});
    const test::ProgramResult result = test::run_program(args);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    return result.err;
  };
  EXPECT_NE(refusal({"genicam:127.0.0.1"}, 2).find("a calibration is needed"), std::string::npos);
  EXPECT_NE(refusal({"webcam", "--calibration", calibration()}, 2).find("\"webcam\" is no camera"),
            std::string::npos);
  EXPECT_EQ(refusal({"genicam:127.0.0.1", "--calibration", calibration()}, 3),
            "lsv: genicam:127.0.0.1: no camera answers at 127.0.0.1; check its cable, its power "
            "and the address\n");
  EXPECT_NE(refusal({"genicam:127.0.0.1", "--calibration", calibration(), "--report-frame", "3"}, 2)
                .find("--report-frame"),
            std::string::npos);
  EXPECT_EQ(refusal({"gst:lsv_no_such_element", "--calibration", calibration()}, 3),
            "lsv: gst:lsv_no_such_element: it cannot be opened\n");
}

// Before the camera is looked for: none is there.
TEST_F(LiveCommand, NoOutputIsAnInputOrAnotherOutput) {
  const std::string folder = test::fresh_directory();
  const std::string input = folder + "/cal.toml";
  const std::string text = test::read_text(calibration());
  std::filesystem::copy_file(calibration(), input);
  std::filesystem::create_symlink("cal.toml", folder + "/link.toml");
  std::filesystem::create_directory(folder + "/sub");
  const auto refused = [&](const std::vector<std::string>& args, const char* why) {
    std::vector<std::string> all = {LSV_PROGRAM, "live", "genicam:127.0.0.1", "--calibration",
                                    input};
    all.insert(all.end(), args.begin(), args.end());
    const test::ProgramResult result = test::run_program(all);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
  };
  const char* const is_input = "is an input of this run";
  const char* const is_twice = "is named for two outputs";
  const std::string a = folder + "/a";
  const std::string also_a = folder + "/sub/../a";
  refused({"--health", folder + "/link.toml"}, is_input);
  refused({"--record", input}, is_input);
  refused({"--csv", a, "--health", also_a}, is_twice);
  refused({"--csv", a, "--jsonl", a}, is_twice);
  refused({"-o", folder + "/out", "--health", folder + "/out/summary.json"}, is_twice);
  refused({"--csv", also_a, "--record", a}, is_twice);
  refused({"--csv", a + ".tail", "--record", also_a}, is_twice);
  refused({"--record", "-"}, "name a file");
  EXPECT_EQ(test::read_text(input), text);
  EXPECT_FALSE(std::filesystem::exists(a));
  EXPECT_FALSE(std::filesystem::exists(folder + "/out"));
}

TEST_F(LiveCommand, ADiskTooFullForTheRecordingCostsNoOtherResult) {
  const std::string folder = test::fresh_directory();
  const std::string camera =
      "gst:videotestsrc num-buffers=200 pattern=snow ! "
      "video/x-raw,format=GRAY8,width=240,height=240,framerate=200/1";
  // Room for the tail, but not for all 11 MB of the frames, even if a busy machine loses half.
  const test::FileLimit limit(4'200'000);
  const test::ProgramResult result = test::run_program(
      {LSV_PROGRAM, "record", camera, folder + "/full.mcap", "--calibration", calibration(), "-o",
       folder + "/out", "--health", folder + "/health.json", "--max-rejected", "1"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_NE(result.err.find("lsv: cannot write " + folder + "/full.mcap"), std::string::npos)
      << result.err;
  EXPECT_GT(count(json::parse(test::read_text(folder + "/health.json")), "received"), 0);
  for (const char* const name : {"track.csv", "summary.json", "report.html"})
    EXPECT_TRUE(std::filesystem::exists(folder + "/out/" + name)) << name;
}

}  // namespace
}  // namespace lsv
