// SPDX-License-Identifier: BSD-3-Clause
// lsv replay, recover, info and track on recordings, through the program.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "calibration/calibration_io.h"
#include "lsv/mcap/writer.h"
#include "lsv/odometer.h"
#include "lsv/record/recorder.h"
#include "sim/speckle.h"
#include "tests/lsv/mcap/scratch.h"
#include "tests/support/calibration.h"
#include "tests/support/csv_table.h"
#include "tests/support/run_program.h"
#include "tests/tools/run_lsv.h"
#include "tools/replay_check.h"

namespace lsv {
namespace {

using test::lsv_run;
using test::ProgramResult;

constexpr int kExposures = 59;

TrackConfig live_config() {
  TrackConfig config = test::bridget_config();
  config.preset = Preset::fast;
  config.gate.min_zncc = 0.25;
  return config;
}

RecorderOptions options_for(const std::string& path, const FrameFormat& format) {
  return {.path = path,
          .format = format,
          .program = "lsv test",
          .source = "simulated speckle",
          .config_toml = "preset = \"fast\"\nmin_zncc = 0.25\nexposure_us = 20\n",
          .calibration_toml = calibration_text(test::bridget_calibration())};
}

/// A live run of which some exposures were lost on the way: neither measured nor recorded.
/// `bend` may change what is recorded of a step.
std::unique_ptr<Recorder> record_run(
    const std::string& path, const std::function<void(StepReport&)>& bend = [](StepReport&) {}) {
  const sim::SpeckleConfig camera_config{.width_px = 72, .height_px = 64, .bit_depth = 12};
  sim::SpeckleCamera camera = sim::SpeckleCamera::create(camera_config).value();
  const FrameFormat format = sim::frame_format(camera_config);
  Odometer odometer = Odometer::create(live_config(), format).value();
  auto recorder = Recorder::create(options_for(path, format)).value();
  Frame frame(format);
  std::int64_t dropped = 0;
  for (int i = 0; i < kExposures; ++i) {
    if (i % 7 == 3 || (i > 30 && i < 34)) {
      ++dropped;
      continue;
    }
    if (!camera.render(i, {.x_px = 2.3 * i, .y_px = 0.4 * i}, frame)) std::abort();
    frame.index = i;
    frame.stamp.ns = 5'000'000'000 + 1'000'123 * std::int64_t{i};
    StreamReport report;
    report.step = odometer.push(frame.view()).value();
    report.label.arrival_ns = frame.stamp.ns;
    report.dropped_before = std::exchange(dropped, 0);
    bend(report.step);
    recorder->on_report(report, frame);
  }
  recorder->on_event(
      {.host_ns = 1, .severity = Severity::warning, .name = "frames_missing", .text = "Some."});
  return recorder;
}

std::int64_t frames_of_run() {
  std::int64_t frames = 0;
  for (int i = 0; i < kExposures; ++i) frames += i % 7 == 3 || (i > 30 && i < 34) ? 0 : 1;
  return frames;
}

/// The table without what names the run.
std::string rows_of(const std::string& csv_path) {
  std::istringstream lines(test::read_text(csv_path));
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) out += line + '\n';
  }
  return out;
}

TEST(Replay, SaysBitForBitWhatWasSaidLiveDroppedFramesIncluded) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  ASSERT_TRUE(record_run(path)->close().ok());
  const ProgramResult replayed = lsv_run({"replay", path, "-o", scratch.file("out")});
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_NE(replayed.err.find(std::to_string(frames_of_run()) + " steps are bit for bit"),
            std::string::npos)
      << replayed.err;
  const test::CsvTable table(test::read_text(scratch.file("out/track.csv")));
  EXPECT_EQ(static_cast<std::int64_t>(table.rows()) + 1, frames_of_run()) << "a row for each shift";
  for (const char* file : {"track.tum", "summary.json", "report.html", "config.toml"})
    EXPECT_TRUE(std::filesystem::exists(scratch.file(std::string("out/") + file))) << file;

  // The same by lsv track, with stamps and indices out of the recording.
  test::write_bytes(scratch.file("cal.toml"),
                    mcap::bytes_of(calibration_text(test::bridget_calibration())));
  const ProgramResult tracked =
      lsv_run({"track", path, "--calibration", scratch.file("cal.toml"), "--preset", "fast",
               "--min-zncc", "0.25", "--csv", scratch.file("track.csv")});
  ASSERT_EQ(tracked.exit_code, 0) << tracked.err;
  EXPECT_EQ(rows_of(scratch.file("track.csv")), rows_of(scratch.file("out/track.csv")));
}

TEST(Replay, NamesTheFirstStepThatIsNotAsRecorded) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  const auto bend = [](StepReport& step) {
    if (step.frame == 18 || step.frame == 20)
      step.position.y_m = std::nextafter(step.position.y_m, 1.0);
  };
  ASSERT_TRUE(record_run(path, bend)->close().ok());
  const ProgramResult replayed = lsv_run({"replay", path, "-q"});
  EXPECT_EQ(replayed.exit_code, 4);
  EXPECT_NE(replayed.err.find("2 of "), std::string::npos) << replayed.err;
  EXPECT_NE(replayed.err.find("frame 18, y_m: "), std::string::npos) << replayed.err;
}

RecordedFrame recorded_step(std::uint32_t ordinal) {
  RecordedFrame out;
  out.ordinal = ordinal;
  out.frame.index = ordinal;
  out.step = StepReport{.frame = ordinal};
  out.step->shift.status = ordinal == 0 ? ShiftStatus::first_frame : ShiftStatus::ok;
  return out;
}

TEST(ReplayCheck, ComparesNothingBehindAFrameThatIsMissing) {
  cli::ReplayCheck check;
  for (const std::uint32_t ordinal : {0U, 1U, 4U, 5U}) {
    const RecordedFrame recorded = recorded_step(ordinal);
    StepReport replayed = *recorded.step;
    if (ordinal > 1) replayed.shift.dx_px = 3.0;
    check.compare(recorded, replayed);
  }
  EXPECT_TRUE(check.identical());
  EXPECT_EQ(check.text(),
            "2 steps are bit for bit as recorded; 2 more cannot be compared, because frames before "
            "frame 4 were measured but are not in the recording");
}

TEST(ReplayCheck, SaysThatARecordingBeganLate) {
  cli::ReplayCheck check;
  const RecordedFrame recorded = recorded_step(7);
  check.compare(recorded, *recorded.step);
  EXPECT_NE(check.text().find("begins in the middle"), std::string::npos) << check.text();
}

TEST(Info, OfARecordingSaysItsConditionTopicsAndEvents) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  ASSERT_TRUE(record_run(path)->close().ok());
  const ProgramResult result = lsv_run({"info", path, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto info = nlohmann::json::parse(result.out);
  EXPECT_EQ(info.at("frames"), frames_of_run());
  EXPECT_EQ(info.at("bit_depth"), 12);
  EXPECT_EQ(info.at("first_stamp_ns"), 5'000'000'000);
  const auto& recording = info.at("recording");
  EXPECT_EQ(recording.at("closed"), true);
  EXPECT_EQ(recording.at("tail"), false);
  EXPECT_EQ(recording.at("dropped"), kExposures - frames_of_run());
  EXPECT_EQ(recording.at("not_recorded"), 0);
  EXPECT_EQ(recording.at("topics").at("/lsv/step").at("messages"), frames_of_run());
  EXPECT_EQ(recording.at("events").at(0).at("name"), "frames_missing");
  const ProgramResult words = lsv_run({"info", path});
  EXPECT_EQ(words.exit_code, 0);
  for (const char* said : {"closed well", "frames_missing: Some.", "/camera/image"})
    EXPECT_NE(words.out.find(said), std::string::npos) << words.out;
}

/// What a process leaves that ends without closing its recording.
void leave_unclosed(const std::string& path) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto recorder = record_run(path);
    ::usleep(300'000);  // for the recorder's thread to take everything
    ::_exit(0);
  }
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
}

TEST(Recover, MakesAReplayableRecordingOfOneThatWasNeverClosed) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  leave_unclosed(path);
  const ProgramResult tracked = lsv_run({"replay", path});
  EXPECT_EQ(tracked.exit_code, 3);
  EXPECT_NE(tracked.err.find("lsv recover"), std::string::npos) << tracked.err;
  const std::string clean = scratch.file("clean.mcap");
  const ProgramResult recovered = lsv_run({"recover", path, "-o", clean});
  ASSERT_EQ(recovered.exit_code, 0) << recovered.out << recovered.err;
  EXPECT_NE(recovered.out.find("nothing is known to be lost"), std::string::npos);
  const ProgramResult replayed = lsv_run({"replay", clean});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_NE(replayed.err.find(std::to_string(frames_of_run()) + " steps are bit for bit"),
            std::string::npos)
      << replayed.err;
  const ProgramResult again = lsv_run({"recover", path, "-o", clean});
  EXPECT_EQ(again.exit_code, 1) << "an existing file is kept";
}

TEST(Recover, SaysWhenSomethingIsLost) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  ASSERT_TRUE(record_run(path)->close().ok());
  mcap::Bytes bytes = test::file_bytes(path);
  bytes[bytes.size() / 2] ^= std::byte{1};
  test::write_bytes(path, bytes);
  const ProgramResult damaged = lsv_run({"replay", path});
  EXPECT_EQ(damaged.exit_code, 3);
  EXPECT_NE(damaged.err.find("a chunk is damaged"), std::string::npos) << damaged.err;
  const std::string clean = scratch.file("clean.mcap");
  const ProgramResult recovered = lsv_run({"recover", path, "-o", clean});
  EXPECT_EQ(recovered.exit_code, 4) << recovered.err;
  EXPECT_NE(recovered.out.find("something is lost"), std::string::npos) << recovered.out;
  test::write_bytes(path, mcap::Bytes(1000));
  EXPECT_EQ(lsv_run({"recover", path, "-o", scratch.file("none.mcap")}).exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(scratch.file("none.mcap")));
}

/// A file as it is when its writer was killed: with a whole chunk in it, or with none.
void write_unclosed(const std::string& path, bool has_chunk) {
  mcap::Writer writer = mcap::Writer::create(mcap::create_file(path).value(),
                                             std::make_unique<mcap::HeapChunk>(4096), {})
                            .value();
  if (!has_chunk) return;
  const auto channel = writer.add_channel({.topic = "note", .message_encoding = "cdr"}).value();
  ASSERT_TRUE(writer.write({.channel = channel}, mcap::Bytes(60)).ok());
  ASSERT_TRUE(writer.flush().ok());
}

TEST(Recover, SaysThatTheEndMayBeLostWithoutATailThatCanBeUsed) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  write_unclosed(path, true);
  const ProgramResult without = lsv_run({"recover", path, "-o", scratch.file("a.mcap")});
  EXPECT_EQ(without.exit_code, 4) << without.out << without.err;
  EXPECT_NE(without.out.find("there is no " + path + ".tail"), std::string::npos) << without.out;
  EXPECT_NE(without.out.find("may be lost"), std::string::npos) << without.out;
  test::write_bytes(path + ".tail", mcap::Bytes(5000, std::byte{3}));
  const ProgramResult damaged = lsv_run({"recover", path, "-o", scratch.file("b.mcap")});
  EXPECT_EQ(damaged.exit_code, 4) << damaged.out << damaged.err;
  EXPECT_NE(damaged.out.find("was not used"), std::string::npos) << damaged.out;
  EXPECT_NE(damaged.out.find("may be lost"), std::string::npos) << damaged.out;
}

TEST(Info, OfARecordingWithoutAFrameSaysWhereSomeMayBe) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  write_unclosed(path, false);
  const ProgramResult alone = lsv_run({"info", path});
  test::expect_one_line_error(alone, 3, "was never closed");
  test::write_bytes(path + ".tail", mcap::Bytes(5000));
  const ProgramResult killed = lsv_run({"info", path});
  test::expect_one_line_error(killed, 3, "was never closed");
  test::expect_one_line_error(killed, 3, "lsv recover may find frames in " + path + ".tail");
  const std::string noise = scratch.file("noise.mcap");
  test::write_bytes(noise, mcap::Bytes(5000, std::byte{0x5A}));
  test::expect_one_line_error(lsv_run({"info", noise}), 3, "noise.mcap: is not an MCAP file");
}

TEST(Replay, IsNotFineWhenNothingCouldBeCompared) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  const auto begun_before = [](StepReport& step) {
    if (step.frame == 0) step.shift.status = ShiftStatus::ok;
  };
  ASSERT_TRUE(record_run(path, begun_before)->close().ok());
  const ProgramResult replayed = lsv_run({"replay", path, "-q"});
  test::expect_one_line_error(replayed, 4, "no step can be compared, because the recording begins");
}

TEST(RecordingCommands, DoNotTakeAFileForStandardOutput) {
  test::expect_one_line_error(lsv_run({"convert", "rec.mcap", "-"}), 2, "name a file");
  test::expect_one_line_error(lsv_run({"recover", "rec.mcap", "-o", "-"}), 2, "name a file");
}

TEST(RecordingCommands, ShowAnExample) {
  for (const char* command : {"live", "record"}) {
    const ProgramResult help = lsv_run({command, "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("says that the camera is ready"), std::string::npos) << command;
  }
  for (const char* command : {"replay", "recover", "info"}) {
    const ProgramResult help = lsv_run({command, "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.out.find("Example"), std::string::npos) << command;
  }
}

}  // namespace
}  // namespace lsv
