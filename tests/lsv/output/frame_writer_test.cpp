// SPDX-License-Identifier: BSD-3-Clause
// What is written is read back to the same counts, or an error names the file.
#include "lsv/output/frame_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "lsv/ingest/frame_source.h"

namespace lsv {
namespace {

namespace fs = std::filesystem;

class FrameWriter : public testing::Test {
 protected:
  FrameWriter() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    directory_ = fs::path(testing::TempDir()) /
                 ("frame_writer_" + std::string(test->name()) + "_" + std::to_string(::getpid()));
    fs::create_directories(directory_);
  }
  ~FrameWriter() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return (directory_ / name).string(); }

  fs::path directory_;
};

constexpr FrameFileFormat kFormats[] = {FrameFileFormat::png, FrameFileFormat::pgm,
                                        FrameFileFormat::tiff, FrameFileFormat::raw};

/// Every count differs from its neighbours; both ends of the scale occur.
Frame pattern(int width_px, int height_px, int bit_depth, int start = 0) {
  Frame frame(FrameFormat{width_px, height_px,
                          bit_depth == 8 ? PixelType::mono8 : PixelType::mono16, bit_depth});
  const int full_scale = full_scale_counts(bit_depth);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const int count = x + y == 0 ? full_scale : (start + x * 37 + y * 1009) % (full_scale + 1);
      if (bit_depth == 8) {
        frame.row8(y)[x] = static_cast<std::uint8_t>(count);
      } else {
        frame.row16(y)[x] = static_cast<std::uint16_t>(count);
      }
    }
  }
  return frame;
}

std::vector<int> counts(const FrameView& view) {
  std::vector<int> out;
  for (int y = 0; y < view.height_px(); ++y) {
    for (int x = 0; x < view.width_px(); ++x) out.push_back(view.at(x, y));
  }
  return out;
}

std::vector<Frame> read_back(const std::string& path, const FrameFormat& format) {
  SourceOptions options;
  options.need_time = false;
  if (path.ends_with(".raw")) options.raw = RawFormat{format, 0};
  auto source = open_frames({path}, options);
  if (!source) {
    ADD_FAILURE() << source.error().message;
    return {};
  }
  std::vector<Frame> frames;
  for (;;) {
    Frame frame;
    const auto more = source.value()->next(frame);
    if (!more) ADD_FAILURE() << more.error().message;
    if (!more || !more.value()) return frames;
    frames.push_back(std::move(frame));
  }
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(FrameWriter, EveryFormatAndDepthReadsBackTheSame) {
  for (const FrameFileFormat format : kFormats) {
    for (const int bit_depth : {8, 10, 12, 14, 16}) {
      const Frame frame = pattern(53, 31, bit_depth);
      const std::string file =
          path("depth" + std::to_string(bit_depth) + std::string(extension(format)));
      const auto written = write_frame(frame.view(), format, file);
      ASSERT_TRUE(written.ok()) << written.error().message;
      const auto frames = read_back(file, frame.view().format);
      ASSERT_EQ(frames.size(), 1U) << file;
      EXPECT_EQ(frames[0].view().format, frame.view().format) << file;
      EXPECT_EQ(counts(frames[0].view()), counts(frame.view())) << file;
    }
  }
}

TEST_F(FrameWriter, ACroppedViewIsWrittenWithoutItsSurroundings) {
  const Frame frame = pattern(64, 48, 12);
  const FrameView part = crop(frame.view(), {5, 7, 31, 20});
  for (const FrameFileFormat format : kFormats) {
    const std::string file = path("crop" + std::string(extension(format)));
    ASSERT_TRUE(write_frame(part, format, file).ok());
    const auto frames = read_back(file, part.format);
    ASSERT_EQ(frames.size(), 1U) << file;
    EXPECT_EQ(counts(frames[0].view()), counts(part)) << file;
  }
}

TEST_F(FrameWriter, ByteOrderIsThatOfTheFormat) {
  Frame frame(FrameFormat{2, 1, PixelType::mono16, 12});
  frame.row16(0)[0] = 0x0123;
  frame.row16(0)[1] = 0x0fff;
  ASSERT_TRUE(write_frame(frame.view(), FrameFileFormat::pgm, path("a.pgm")).ok());
  EXPECT_EQ(bytes_of(path("a.pgm")), std::string("P5\n2 1\n4095\n\x01\x23\x0f\xff", 16));
  ASSERT_TRUE(write_frame(frame.view(), FrameFileFormat::raw, path("a.raw")).ok());
  EXPECT_EQ(bytes_of(path("a.raw")), std::string("\x23\x01\xff\x0f", 4));
}

TEST_F(FrameWriter, AStackHoldsItsPagesInOrder) {
  for (const std::int64_t expected_bytes : {std::int64_t{0}, std::int64_t{5'000'000'000}}) {
    auto stack = TiffStackWriter::create(path("stack.tif"), expected_bytes);
    ASSERT_TRUE(stack.ok()) << stack.error().message;
    for (int page = 0; page < 20; ++page)
      ASSERT_TRUE(stack.value().append(pattern(40, 24, 10, page).view()).ok());
    ASSERT_TRUE(stack.value().commit().ok());
    EXPECT_FALSE(stack.value().append(pattern(40, 24, 10).view()).ok());
    EXPECT_FALSE(stack.value().commit().ok());
    const auto frames = read_back(path("stack.tif"), {});
    ASSERT_EQ(frames.size(), 20U);
    for (int page = 0; page < 20; ++page) {
      EXPECT_EQ(counts(frames[static_cast<std::size_t>(page)].view()),
                counts(pattern(40, 24, 10, page).view()));
    }
    EXPECT_EQ(frames[0].view().format.bit_depth, 10);
    EXPECT_EQ(static_cast<unsigned char>(bytes_of(path("stack.tif"))[2]),
              expected_bytes > 0 ? 43 : 42);
  }
}

TEST_F(FrameWriter, AnUnfinishedStackLeavesNothingAndKeepsTheOlderFile) {
  std::ofstream(path("stack.tif")) << "older";
  {
    auto stack = TiffStackWriter::create(path("stack.tif"), 0);
    ASSERT_TRUE(stack.ok());
    ASSERT_TRUE(stack.value().append(pattern(40, 24, 8).view()).ok());
    TiffStackWriter moved = std::move(stack).value();
    ASSERT_TRUE(moved.append(pattern(40, 24, 8).view()).ok());
  }
  EXPECT_EQ(bytes_of(path("stack.tif")), "older");
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), {}), 1);
}

TEST_F(FrameWriter, AFileIsReplacedWhole) {
  for (const FrameFileFormat format : kFormats) {
    const std::string file = path("again" + std::string(extension(format)));
    ASSERT_TRUE(write_frame(pattern(64, 64, 16).view(), format, file).ok());
    ASSERT_TRUE(write_frame(pattern(8, 8, 8).view(), format, file).ok());
    const auto frames = read_back(file, pattern(8, 8, 8).view().format);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(counts(frames[0].view()), counts(pattern(8, 8, 8).view()));
  }
}

TEST_F(FrameWriter, AnErrorNamesTheFileAndLeavesNothing) {
  for (const FrameFileFormat format : kFormats) {
    const std::string file = path("no_such_directory/frame" + std::string(extension(format)));
    const auto written = write_frame(pattern(8, 8, 8).view(), format, file);
    ASSERT_FALSE(written.ok());
    EXPECT_EQ(written.error().code, ErrorCode::output_failed);
    EXPECT_NE(written.error().message.find(file), std::string::npos) << written.error().message;
  }
  EXPECT_TRUE(fs::is_empty(directory_));
}

TEST_F(FrameWriter, ATargetThatIsADirectoryIsAnError) {
  fs::create_directories(path("taken.tif/inside"));
  const auto written =
      write_frame(pattern(8, 8, 8).view(), FrameFileFormat::tiff, path("taken.tif"));
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::output_failed);
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), {}), 1);
}

TEST(FrameFileFormat, WordsAndExtensions) {
  EXPECT_EQ(frame_file_format_from("png"), FrameFileFormat::png);
  EXPECT_EQ(frame_file_format_from("tiff"), FrameFileFormat::tiff);
  EXPECT_FALSE(frame_file_format_from("jpeg").has_value());
  EXPECT_FALSE(frame_file_format_from("").has_value());
  EXPECT_EQ(extension(FrameFileFormat::tiff), ".tif");
}

}  // namespace
}  // namespace lsv
