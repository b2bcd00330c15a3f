// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/record/recorder.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "lsv/mcap/sealed.h"
#include "lsv/mcap/tail.h"
#include "tests/lsv/mcap/scratch.h"
#include "tests/lsv/record/recorded_stream.h"

namespace lsv {
namespace {

using test::kSmallFormat;
using test::Recorded;

void expect_frame(const test::RecordedFrame& frame, std::int64_t index) {
  Frame expected;
  StreamReport report;
  test::fill(index, expected, report);
  EXPECT_EQ(frame.note.index, index);
  EXPECT_EQ(frame.note.stamp_ns, expected.stamp.ns);
  EXPECT_EQ(frame.note.bit_depth, 8);
  EXPECT_EQ(frame.note.camera_id, report.label.camera_id);
  EXPECT_TRUE(frame.note.has_camera_ns);
  EXPECT_EQ(frame.note.camera_ns, report.label.camera_ns);
  EXPECT_EQ(frame.note.arrival_ns, report.label.arrival_ns);
  EXPECT_EQ(frame.note.missing_before, report.missing_before);
  EXPECT_EQ(frame.note.dropped_before, report.dropped_before);
  EXPECT_EQ(frame.note.rejected_before, report.rejected_before);
  EXPECT_EQ(frame.note.latency_ns, report.latency_ns);
  EXPECT_EQ(mcap::first_difference(frame.step, report.step), "");
  ASSERT_EQ(frame.pixels.size(), 45U);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 9; ++x)
      ASSERT_EQ(static_cast<int>(frame.pixels[static_cast<std::size_t>(y * 9 + x)]),
                test::pixel(index, x, y));
  }
}

class RecorderWith : public testing::TestWithParam<mcap::Compression> {};

TEST_P(RecorderWith, KeepsEverythingThatTheStreamSaid) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  RecorderOptions options = test::recorder_options(path);
  options.compression = GetParam();
  options.queue_frames = 200;
  auto recorder = Recorder::create(options);
  ASSERT_TRUE(recorder.ok()) << recorder.error().message;
  EXPECT_TRUE(std::filesystem::exists(mcap::tail_path(path)));
  Frame frame;
  for (std::int64_t index = 0; index < 100; ++index) {
    test::push(*recorder.value(), index, frame);
    EXPECT_EQ(frame.view().format, kSmallFormat) << "a frame to fill again";
  }
  recorder.value()->on_event(test::some_event());
  recorder.value()->on_health(test::some_health());
  const Result<void> closed = recorder.value()->close();
  ASSERT_TRUE(closed.ok()) << closed.error().message;
  EXPECT_EQ(recorder.value()->frames_dropped(), 0);
  EXPECT_FALSE(std::filesystem::exists(mcap::tail_path(path)));

  const Recorded back = test::read_recording(mcap::open_file(path).value());
  EXPECT_EQ(back.error, "");
  ASSERT_EQ(back.frames.size(), 100U);
  for (std::uint32_t i = 0; i < 100; ++i) {
    EXPECT_EQ(back.frames[i].ordinal, i);
    expect_frame(back.frames[i], i);
  }
  EXPECT_EQ(back.odometry, 75) << "accepted shifts only";
  EXPECT_TRUE(back.dropouts.empty());
  ASSERT_EQ(back.events.size(), 1U);
  EXPECT_EQ(back.events[0].name, "frames_missing");
  EXPECT_EQ(back.events[0].text, "Two.");
  EXPECT_EQ(back.events[0].severity, mcap::Severity::warning);
  ASSERT_EQ(back.health.size(), 1U);
  EXPECT_EQ(back.health[0].state, StreamState::running);
  EXPECT_EQ(back.health[0].missing, 2);
  EXPECT_EQ(back.health[0].rejected[3], 7);
  EXPECT_EQ(back.health[0].latency.p99_s, 0.25);
  for (const std::string_view name :
       {mcap::kRecordingMetadata, mcap::kConfigMetadata, mcap::kCalibrationMetadata}) {
    ASSERT_EQ(back.metadata.count(std::string(name)), 1U) << name;
    EXPECT_TRUE(mcap::is_sealed(back.metadata.at(std::string(name))));
  }
  EXPECT_EQ(back.metadata.at("lsv.config").entries.at("config.toml"), options.config_toml);
  EXPECT_EQ(back.metadata.at("lsv.calibration").entries.at("calibration.toml"),
            options.calibration_toml);
  ASSERT_EQ(back.attachments.size(), 1U);
  EXPECT_EQ(back.attachments[0].name, mcap::kSensorMapsAttachment);
  EXPECT_EQ(back.attachments[0].data, options.sensor_maps_tiff);
}

INSTANTIATE_TEST_SUITE_P(Chunks, RecorderWith,
                         testing::Values(mcap::Compression::none, mcap::Compression::zstd),
                         [](const auto& each) {
                           return each.param == mcap::Compression::zstd ? "zstd" : "plain";
                         });

TEST(Recorder, OverwritesNeitherARecordingNorATail) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  test::write_bytes(path, mcap::Bytes(3));
  EXPECT_FALSE(Recorder::create(test::recorder_options(path)).ok());
  EXPECT_FALSE(std::filesystem::exists(mcap::tail_path(path)));
  EXPECT_EQ(test::file_bytes(path).size(), 3U);
  const std::string other = scratch.file("other.mcap");
  test::write_bytes(mcap::tail_path(other), mcap::Bytes(3));
  EXPECT_FALSE(Recorder::create(test::recorder_options(other)).ok());
  EXPECT_FALSE(std::filesystem::exists(other));
  EXPECT_EQ(test::file_bytes(mcap::tail_path(other)).size(), 3U);
}

TEST(Recorder, ClosesWithoutAFrame) {
  const test::Scratch scratch;
  const std::string path = scratch.file("rec.mcap");
  ASSERT_TRUE(Recorder::create(test::recorder_options(path)).value()->close().ok());
  const Recorded back = test::read_recording(mcap::open_file(path).value());
  EXPECT_EQ(back.error, "");
  EXPECT_TRUE(back.condition.finished);
}

}  // namespace
}  // namespace lsv
