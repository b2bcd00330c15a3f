// SPDX-License-Identifier: BSD-3-Clause
// Cameras through OpenCV: a GStreamer pipeline that makes its own pictures stands for them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <opencv2/core/utils/logger.hpp>
#include <thread>
#include <vector>

#include "lsv/camera/open_camera.h"
#include "lsv/camera/video_camera_source.h"

namespace lsv {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t kLong_ns = 20 * kNsPerS;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class VideoCamera : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    silence_camera_libraries();
  }
};

std::unique_ptr<LiveSource> open_pipeline(const std::string& pipeline,
                                          const CameraOptions& options = {}) {
  auto source = open_camera("gst:" + pipeline, options);
  EXPECT_TRUE(source) << source.error().message;
  return source ? std::move(source).value() : nullptr;
}

/// A camera whose frames come when the test writes them: 8 x 6 px at 50 Hz by its own account.
class PipeCamera {
 public:
  explicit PipeCamera(const std::string& format) {
    EXPECT_EQ(::pipe(ends_.data()), 0);
    format_ = format;
  }
  PipeCamera(const PipeCamera&) = delete;
  PipeCamera& operator=(const PipeCamera&) = delete;
  ~PipeCamera() {
    end();
    // The pipeline may still read from the other end.
  }

  std::string pipeline() const {
    return "fdsrc fd=" + std::to_string(ends_[0]) +
           " ! rawvideoparse width=8 height=6 framerate=50/1 format=" + format_;
  }
  /// Every byte of the frame is `value`, but the first, which is 7.
  void send(int value, std::size_t bytes = 48) {
    std::vector<std::uint8_t> pixels(bytes, static_cast<std::uint8_t>(value));
    pixels[0] = 7;
    EXPECT_EQ(::write(ends_[1], pixels.data(), pixels.size()), static_cast<ssize_t>(bytes));
  }
  void end() {
    if (ends_[1] >= 0) ::close(ends_[1]);
    ends_[1] = -1;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
  std::string format_;
};

TEST_F(VideoCamera, APipelineIsReadToItsEnd) {
  PipeCamera camera("gray8");
  camera.send(100);
  const auto source = open_pipeline(camera.pipeline());
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->info().format, (FrameFormat{.width_px = 8, .height_px = 6}));
  EXPECT_EQ(source->info().period_ns, kNsPerS / 50);
  EXPECT_EQ(source->info().id_bits, 64);
  Frame frame;
  FrameLabel label;
  std::int64_t last_arrival_ns = 0;
  for (int i = 0; i < 5; ++i) {
    if (i > 0) camera.send(100 + i);
    const Result<Grab> got = source->grab(frame, label, kLong_ns);
    ASSERT_TRUE(got) << got.error().message;
    ASSERT_EQ(got.value(), Grab::frame) << i;
    EXPECT_EQ(label.camera_id, static_cast<std::uint64_t>(i));
    EXPECT_EQ(label.camera_ns, label.arrival_ns);
    EXPECT_FALSE(label.damaged);
    EXPECT_GT(label.arrival_ns, last_arrival_ns);
    last_arrival_ns = label.arrival_ns;
    EXPECT_EQ(frame.view().at(0, 0), 7);
    EXPECT_EQ(frame.view().at(7, 5), 100 + i);
  }
  camera.end();
  EXPECT_EQ(source->grab(frame, label, kLong_ns).value(), Grab::ended);
  EXPECT_EQ(source->transport_losses(), 0);
}

TEST_F(VideoCamera, SixteenBitsAreKept) {
  PipeCamera camera("gray16-le");
  camera.send(0x12, 96);
  const auto source =
      open_pipeline(camera.pipeline() + " ! video/x-raw,format=GRAY16_LE ! appsink");
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->info().format, (FrameFormat{8, 6, PixelType::mono16, 16}));
  Frame frame;
  FrameLabel label;
  ASSERT_EQ(source->grab(frame, label, kLong_ns).value(), Grab::frame);
  EXPECT_EQ(frame.view().at(0, 0), 0x1207);
  EXPECT_EQ(frame.view().at(7, 5), 0x1212);
}

TEST_F(VideoCamera, FramesThatNobodyGrabsAreCounted) {
  PipeCamera camera("gray8");
  for (int i = 0; i < 12; ++i) camera.send(i);
  CameraOptions options;
  options.buffers = 4;
  const auto source = open_pipeline(camera.pipeline(), options);
  ASSERT_NE(source, nullptr);
  for (const auto start = Clock::now();
       source->transport_losses() < 8 && seconds_since(start) < 20.0;)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(source->transport_losses(), 8);
  camera.send(99);
  Frame frame;
  FrameLabel label;
  for (const std::uint64_t id : {0U, 1U, 2U, 3U}) {
    ASSERT_EQ(source->grab(frame, label, kLong_ns).value(), Grab::frame);
    EXPECT_EQ(label.camera_id, id);
    EXPECT_EQ(frame.view().at(7, 5), static_cast<int>(id));
  }
}

TEST_F(VideoCamera, SilenceIsNoticedAndHoldsNobodyUp) {
  PipeCamera camera("gray8");
  camera.send(1);
  CameraOptions options;
  options.gone_after_ns = kNsPerS / 5;
  auto source = open_pipeline(camera.pipeline(), options);
  ASSERT_NE(source, nullptr);
  Frame frame;
  FrameLabel label;
  ASSERT_EQ(source->grab(frame, label, kLong_ns).value(), Grab::frame);
  Result<Grab> got = Grab::nothing;
  std::int64_t waits = 0;
  for (const auto start = Clock::now(); got && seconds_since(start) < 20.0; ++waits)
    got = source->grab(frame, label, kNsPerS / 100);
  EXPECT_GT(waits, 2);
  ASSERT_FALSE(got);
  EXPECT_NE(got.error().message.find("nothing has come for"), std::string::npos)
      << got.error().message;
  const auto closing = Clock::now();
  source.reset();  // while OpenCV waits for a frame that does not come
  EXPECT_LT(seconds_since(closing), 2.0);
}

TEST_F(VideoCamera, StopEndsAWaitSoon) {
  PipeCamera camera("gray8");
  camera.send(1);
  const auto source = open_pipeline(camera.pipeline());
  ASSERT_NE(source, nullptr);
  Frame frame;
  FrameLabel label;
  ASSERT_EQ(source->grab(frame, label, kLong_ns).value(), Grab::frame);
  const auto start = Clock::now();
  std::thread stopper([&source] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    source->stop();
  });
  const Result<Grab> got = source->grab(frame, label, kLong_ns);
  stopper.join();
  EXPECT_LT(seconds_since(start), 2.0);
  EXPECT_TRUE(got) << got.error().message;
  camera.end();
}

TEST_F(VideoCamera, WhatCannotBeIsRefusedInOneSentence) {
  const auto refusal = [](const std::string& source, const CameraOptions& options) {
    auto opened = open_camera(source, options);
    return opened ? "opened" : opened.error().message;
  };
  EXPECT_EQ(refusal("v4l:/dev/lsv_no_such_camera", {}),
            "v4l:/dev/lsv_no_such_camera: it cannot be opened");
  EXPECT_EQ(refusal("gst:lsv_no_such_element", {}), "gst:lsv_no_such_element: it cannot be opened");
  EXPECT_NE(refusal("gst:videotestsrc num-buffers=3 ! video/x-raw,format=BGR", {})
                .find("the frames are not grey"),
            std::string::npos);
  CameraOptions exposure;
  exposure.exposure_s = 0.001;
  EXPECT_NE(refusal("v4l:/dev/video0", exposure).find("v4l2-ctl"), std::string::npos);
  EXPECT_NE(refusal("gst:videotestsrc", exposure).find("the pipeline itself says"),
            std::string::npos);
  CameraOptions region;
  region.region = Roi{.x_px = 1, .y_px = 0, .width_px = 8, .height_px = 8};
  EXPECT_NE(refusal("v4l:/dev/video0", region).find("must begin at (0, 0)"), std::string::npos);
  for (const char* const word : {"webcam", "usb:1", "", ":", "Genicam:1"}) {
    EXPECT_EQ(refusal(word, {}), std::string("\"") + word +
                                     "\" is no camera: give genicam:ADDRESS-OR-ID, "
                                     "v4l:/dev/videoN or gst:PIPELINE");
  }
}

}  // namespace
}  // namespace lsv
