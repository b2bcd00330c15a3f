// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/video_source.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "lsv/ingest/frame_source.h"
#include "tests/support/test_images.h"

namespace lsv {
namespace {

class VideoSourceTest : public testing::Test {
 protected:
  void SetUp() override {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = test::fresh_folder(testing::TempDir(), std::string("video_") + test->name());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// False when this OpenCV has no such encoder.
  bool write_video(const std::string& path, const std::string& codec,
                   const std::vector<test::TestImage>& images) {
    const test::TestImage& first = images.front();
    cv::VideoWriter writer(path, cv::CAP_FFMPEG,
                           cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), 25.0,
                           {first.width_px, first.height_px}, first.channels == 3);
    if (!writer.isOpened()) return false;
    for (const test::TestImage& image : images) {
      cv::Mat pixels(image.height_px, image.width_px, CV_8UC(image.channels));
      for (std::size_t i = 0; i < image.samples.size(); ++i)
        pixels.data[i] = static_cast<std::uint8_t>(image.samples[i]);
      writer.write(pixels);
    }
    return true;
  }

  std::filesystem::path folder_;
};

std::vector<test::TestImage> grey_images(int count) {
  std::vector<test::TestImage> images;
  for (int i = 0; i < count; ++i)
    images.push_back(test::random_image(64, 48, static_cast<std::uint32_t>(i)));
  return images;
}

TEST_F(VideoSourceTest, LosslessVideoKeepsEveryGreyValue) {
  const auto images = grey_images(5);
  const std::string path = (folder_ / "v.avi").string();
  if (!write_video(path, "FFV1", images)) GTEST_SKIP() << "no FFV1 encoder";
  auto source = open_frames({path}, {.rate_hz = 500.0});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_TRUE(source.value()->info().warnings.empty());
  Frame frame;
  for (std::int64_t i = 0; i < 5; ++i) {
    const auto got = source.value()->next(frame);
    ASSERT_TRUE(got && got.value()) << i;
    EXPECT_TRUE(test::same_pixels(frame.view(), images[static_cast<std::size_t>(i)])) << i;
    EXPECT_EQ(frame.stamp.ns, i * 2'000'000) << "the rate of the container must not be used";
  }
  EXPECT_FALSE(source.value()->next(frame).value());
}

TEST_F(VideoSourceTest, TheRateOfTheContainerIsNotATimeBase) {
  const std::string path = (folder_ / "v.avi").string();
  if (!write_video(path, "FFV1", grey_images(2))) GTEST_SKIP() << "no FFV1 encoder";
  const auto source = open_frames({path}, {});
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::invalid_argument);
}

TEST_F(VideoSourceTest, LossyCodecIsNamed) {
  const std::string path = (folder_ / "v.avi").string();
  if (!write_video(path, "MJPG", grey_images(3))) GTEST_SKIP() << "no MJPG encoder";
  const auto source = open_frames({path}, {.need_time = false});
  ASSERT_TRUE(source) << source.error().message;
  ASSERT_FALSE(source.value()->info().warnings.empty());
  EXPECT_NE(source.value()->info().warnings.back().find("MJPG"), std::string::npos);
}

TEST_F(VideoSourceTest, ColourVideoIsSaid) {
  const std::string path = (folder_ / "v.avi").string();
  if (!write_video(path, "FFV1", {test::random_image(64, 48, 1, 255, 3)}))
    GTEST_SKIP() << "no FFV1 encoder";
  const auto source = open_frames({path}, {.need_time = false});
  ASSERT_TRUE(source) << source.error().message;
  ASSERT_FALSE(source.value()->info().warnings.empty());
  EXPECT_NE(source.value()->info().warnings.front().find("luma"), std::string::npos);
}

TEST_F(VideoSourceTest, ACutVideoIsAnError) {
  const std::string path = (folder_ / "v.avi").string();
  if (!write_video(path, "FFV1", grey_images(30))) GTEST_SKIP() << "no FFV1 encoder";
  test::Bytes bytes = test::read_bytes(path);
  for (const unsigned divisor : {2U, 4U, 16U}) {
    const auto keep = static_cast<std::ptrdiff_t>(bytes.size() / divisor);
    const std::string cut = (folder_ / "cut.avi").string();
    test::write_bytes(cut, test::Bytes(bytes.begin(), bytes.begin() + keep));
    auto source = open_frames({cut}, {.need_time = false});
    std::optional<Error> error;
    if (!source) {
      error = source.error();
    } else {
      Frame frame;
      for (;;) {
        const auto got = source.value()->next(frame);
        if (!got) error = got.error();
        if (!got || !got.value()) break;
      }
    }
    ASSERT_TRUE(error) << "1/" << divisor;
    EXPECT_NE(error->message.find("cut.avi"), std::string::npos) << error->message;
  }
}

TEST_F(VideoSourceTest, OtherContentUnderAVideoNameIsRefused) {
  const std::string path = (folder_ / "v.mp4").string();
  test::write_bytes(path, test::bytes_of("#EXTM3U\n#EXTINF:1,\nhttp://localhost/x.ts\n"));
  const auto source = open_frames({path}, {.need_time = false});
  ASSERT_FALSE(source);
  EXPECT_NE(source.error().message.find("v.mp4"), std::string::npos);
}

}  // namespace
}  // namespace lsv
