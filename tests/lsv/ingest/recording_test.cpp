// SPDX-License-Identifier: BSD-3-Clause
// Recordings of other programs: images of ROS 2 and nothing of lsv.
#include "lsv/ingest/recording.h"

#include <gtest/gtest.h>

#include "lsv/ingest/frame_source.h"
#include "lsv/mcap/byte_sink.h"
#include "lsv/mcap/cdr.h"
#include "lsv/mcap/writer.h"
#include "tests/lsv/mcap/scratch.h"

namespace lsv {
namespace {

struct TestImage {
  std::int64_t stamp_ns = 0;
  std::uint32_t width_px = 3;
  std::uint32_t height_px = 2;
  std::string encoding = "mono16";
  bool big_endian = false;
  std::uint32_t step_bytes = 6;
  mcap::Bytes data = mcap::Bytes(12);
};

mcap::Bytes encoded(const TestImage& image) {
  mcap::Bytes out;
  mcap::CdrWriter cdr(out);
  cdr.number(static_cast<std::int32_t>(image.stamp_ns / kNsPerS));
  cdr.number(static_cast<std::uint32_t>(image.stamp_ns % kNsPerS));
  cdr.text("camera");
  cdr.number(image.height_px);
  cdr.number(image.width_px);
  cdr.text(image.encoding);
  cdr.number(static_cast<std::uint8_t>(image.big_endian));
  cdr.number(image.step_bytes);
  cdr.number(static_cast<std::uint32_t>(image.data.size()));
  cdr.raw(image.data);
  return out;
}

/// Images on /left, each logged a second after the one before.
std::string write_images(const test::Scratch& scratch, const std::vector<TestImage>& images) {
  const std::string path = scratch.file("bag.MCAP");
  auto writer = mcap::Writer::create(mcap::create_file(path).value(),
                                     std::make_unique<mcap::HeapChunk>(1000), {})
                    .value();
  const auto add = [&](const char* topic, std::string_view type) {
    return writer
        .add_channel({.topic = topic, .message_encoding = "cdr", .schema = mcap::schema_of(type)})
        .value();
  };
  const auto left = add("/left", mcap::kImageType);
  const auto right = add("/right", mcap::kImageType);
  const auto log = add("/rosout", mcap::kEventType);
  std::int64_t log_time_ns = 1'000'000'000;
  for (const TestImage& image : images) {
    EXPECT_TRUE(writer.write({.channel = log}, mcap::Bytes(3)).ok()) << "not of lsv, so not read";
    EXPECT_TRUE(writer.write({.channel = left, .log_time_ns = log_time_ns}, encoded(image)).ok());
    EXPECT_TRUE(writer.write({.channel = right, .log_time_ns = log_time_ns}, mcap::Bytes(9)).ok());
    log_time_ns += 1'000'000'000;
  }
  EXPECT_TRUE(writer.finish().ok());
  return path;
}

Result<std::unique_ptr<FrameSource>> open(const std::string& path, SourceOptions options = {}) {
  return open_frames({path}, options);
}

TEST(ForeignRecording, Of16BitBigEndianPaddedImages) {
  const test::Scratch scratch;
  TestImage image{.stamp_ns = 7'000'000'001, .big_endian = true, .step_bytes = 8};
  image.data = mcap::Bytes(16, std::byte{0xEE});
  for (const std::size_t at : {0U, 2U, 4U, 8U, 10U, 12U}) {
    image.data[at] = std::byte{1};
    image.data[at + 1] = static_cast<std::byte>(at);
  }
  TestImage later = image;
  later.stamp_ns += 500;
  auto source = open(write_images(scratch, {image, later}));
  ASSERT_TRUE(source.ok()) << source.error().message;
  EXPECT_EQ(source.value()->info().description, "MCAP recording, /left");
  EXPECT_EQ(source.value()->info().first_stamp->ns, 7'000'000'001);
  Frame frame;
  ASSERT_TRUE(source.value()->next(frame).value());
  EXPECT_EQ(frame.view().format.bit_depth, 16);
  EXPECT_EQ(frame.index, 0);
  EXPECT_EQ(frame.view().at(0, 0), 256);
  EXPECT_EQ(frame.view().at(2, 1), 256 + 12);
  ASSERT_TRUE(source.value()->next(frame).value());
  EXPECT_EQ(frame.index, 1);
  EXPECT_EQ(frame.stamp.ns, 7'000'000'501);
  EXPECT_FALSE(source.value()->next(frame).value());
}

TEST(ForeignRecording, TakesTheTimeOfRecordingWhereImagesHaveNone) {
  const test::Scratch scratch;
  auto source = open(write_images(scratch, {{}, {}}));
  ASSERT_TRUE(source.ok()) << source.error().message;
  Frame frame;
  ASSERT_TRUE(source.value()->next(frame).value());
  EXPECT_EQ(frame.stamp.ns, 1'000'000'000);
  ASSERT_TRUE(source.value()->next(frame).value());
  EXPECT_EQ(frame.stamp.ns, 2'000'000'000);
}

TEST(ForeignRecording, ARateThatIsAskedForStandsAboveItsStamps) {
  const test::Scratch scratch;
  auto source =
      open(write_images(scratch, {{.stamp_ns = 5}, {.stamp_ns = 6}}), {.rate_hz = 1000.0});
  Frame frame;
  ASSERT_TRUE(source.value()->next(frame).value());
  ASSERT_TRUE(source.value()->next(frame).value());
  EXPECT_EQ(frame.stamp.ns, 1'000'000);
}

TEST(ForeignRecording, PicksFramesByIndex) {
  const test::Scratch scratch;
  const std::string path = write_images(scratch, std::vector<TestImage>(6));
  auto source = open(path, {.start = 1, .stop = 5, .step = 2});
  ASSERT_TRUE(source.ok()) << source.error().message;
  Frame frame;
  std::vector<std::int64_t> indices;
  while (source.value()->next(frame).value()) indices.push_back(frame.index);
  EXPECT_EQ(indices, (std::vector<std::int64_t>{1, 3}));
}

TEST(ForeignRecording, RefusesImagesThatCannotBe) {
  const test::Scratch scratch;
  const std::pair<TestImage, const char*> cases[] = {
      {{.encoding = "rgb8"}, "rgb8"},
      {{.width_px = 0}, "no pixels"},
      {{.step_bytes = 5}, "fewer pixels"},
      {{.data = mcap::Bytes(11)}, "fewer pixels"},
      {{.width_px = 1U << 31U, .height_px = 1U << 31U, .step_bytes = 1U << 31U}, "more than lsv"},
      {{.width_px = 1, .height_px = 1U << 31U, .step_bytes = 2}, "more than lsv"}};
  for (const auto& [image, what] : cases) {
    const std::string path = write_images(scratch, {image});
    const auto source = open(path);
    ASSERT_FALSE(source.ok()) << what;
    EXPECT_NE(source.error().message.find(what), std::string::npos) << source.error().message;
    EXPECT_NE(source.error().message.find(path + ", image 0"), std::string::npos);
    std::filesystem::remove(path);
  }
}

TEST(ForeignRecording, WithoutImagesHoldsNoFrame) {
  const test::Scratch scratch;
  const auto source = open(write_images(scratch, {}));
  ASSERT_FALSE(source.ok());
  EXPECT_NE(source.error().message.find("no frame"), std::string::npos);
}

}  // namespace
}  // namespace lsv
