// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/tiff_stack.h"

#include <gtest/gtest.h>

#include "lsv/ingest/frame_source.h"
#include "tests/support/test_images.h"

namespace lsv {
namespace {

class TiffStackTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = test::fresh_folder(testing::TempDir(), std::string("stack_") + test->name());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path() const { return (folder_ / "stack.tif").string(); }

  std::filesystem::path folder_;
};

std::vector<test::TestImage> pages_of(int count, int max_value = 255) {
  std::vector<test::TestImage> pages;
  for (int i = 0; i < count; ++i)
    pages.push_back(test::random_image(11, 7, static_cast<std::uint32_t>(100 + i), max_value));
  return pages;
}

TEST_F(TiffStackTest, PagesArriveInOrderInEveryLayout) {
  for (const test::TiffLayout& layout :
       {test::TiffLayout{}, test::TiffLayout{.compression = 5},
        test::TiffLayout{.compression = 8, .tile_px = 16}, test::TiffLayout{.mode = "w8"}}) {
    const auto pages = pages_of(5, 65535);
    test::write_tiff(path(), pages, layout);
    auto source = open_frames({path()}, {.rate_hz = 10.0});
    ASSERT_TRUE(source) << source.error().message;
    EXPECT_EQ(source.value()->info().description, "TIFF stack");
    EXPECT_EQ(source.value()->info().frame_count, 5);
    Frame frame;
    for (std::int64_t i = 0; i < 5; ++i) {
      const auto got = source.value()->next(frame);
      ASSERT_TRUE(got && got.value()) << i;
      EXPECT_EQ(frame.index, i);
      EXPECT_EQ(frame.stamp.ns, i * 100'000'000);
      EXPECT_TRUE(test::same_pixels(frame.view(), pages[static_cast<std::size_t>(i)]));
    }
    EXPECT_FALSE(source.value()->next(frame).value());
  }
}

TEST_F(TiffStackTest, StartAndStepPassOverPages) {
  const auto pages = pages_of(9);
  test::write_tiff(path(), pages);
  auto source = open_frames({path()}, {.need_time = false, .start = 2, .stop = 8, .step = 3});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ(source.value()->info().frame_count, 2);
  Frame frame;
  for (const std::int64_t i : {2, 5}) {
    ASSERT_TRUE(source.value()->next(frame).value());
    EXPECT_EQ(frame.index, i);
    EXPECT_TRUE(test::same_pixels(frame.view(), pages[static_cast<std::size_t>(i)]));
  }
  EXPECT_FALSE(source.value()->next(frame).value());
}

TEST_F(TiffStackTest, ThousandsOfPagesAreCountedAndRead) {
  test::write_bytes(path(), test::encode(test::HandmadeTiff{.pages = 20'000}));
  auto source = open_frames({path()}, {.need_time = false});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ(source.value()->info().frame_count, 20'000);
  Frame frame;
  std::int64_t frames = 0;
  while (source.value()->next(frame).value()) ++frames;
  EXPECT_EQ(frames, 20'000);
}

TEST_F(TiffStackTest, APageOfAnotherSizeIsNamed) {
  auto pages = pages_of(3);
  pages.push_back(test::random_image(12, 7, 1));
  test::write_tiff(path(), pages);
  auto source = open_frames({path()}, {.need_time = false});
  ASSERT_TRUE(source) << source.error().message;
  Frame frame;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(source.value()->next(frame).value());
  const auto fourth = source.value()->next(frame);
  ASSERT_FALSE(fourth);
  EXPECT_NE(fourth.error().message.find("stack.tif, page 3"), std::string::npos);
  EXPECT_NE(fourth.error().message.find("12 x 7"), std::string::npos);
  EXPECT_NE(fourth.error().message.find("11 x 7"), std::string::npos);
  EXPECT_FALSE(source.value()->next(frame).value()) << "after an error the source is finished";
}

TEST_F(TiffStackTest, ALoopOfPagesIsRefusedAtOpening) {
  test::write_bytes(path(), test::encode({.pages = 4, .last_next = test::page_offset(1)}));
  const auto source = open_frames({path()}, {.need_time = false});
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::bad_input);
  EXPECT_NE(source.error().message.find("stack.tif"), std::string::npos);
}

TEST_F(TiffStackTest, NothingIsPrinted) {
  test::write_bytes(path(), test::encode({.width = 65535, .height = 65535}));
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  EXPECT_FALSE(open_frames({path()}, {.need_time = false}));
  test::write_bytes(path(), test::bytes_of("II*\0 this is no tiff"));
  EXPECT_FALSE(open_frames({path()}, {.need_time = false}));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace lsv
