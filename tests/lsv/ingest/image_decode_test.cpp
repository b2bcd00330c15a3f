// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/image_decode.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/hostile_files.h"

namespace lsv {
namespace {

using test::TestImage;

class ImageDecode : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = test::fresh_folder(testing::TempDir(), std::string("decode_") + test->name());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& name, const test::Bytes& bytes) {
    test::write_bytes(folder_ / name, bytes);
    return (folder_ / name).string();
  }

  Result<ImageNotes> read(const std::string& path, Frame& out, DecodeOptions options = {}) {
    if (options.max_pixels == 0) options.max_pixels = 1'000'000;
    return ImageReader(options).read(path, image_kind_of(path).value(), out);
  }

  std::string refusal(const std::string& path, DecodeOptions options = {}) {
    Frame frame;
    const auto result = read(path, frame, options);
    EXPECT_FALSE(result) << path;
    if (result) return "";
    EXPECT_NE(result.error().message.find(path), std::string::npos) << result.error().message;
    return result.error().message;
  }

  std::filesystem::path folder_;
};

int rec601(int r, int g, int b) {
  return static_cast<int>(0.299 * r + 0.587 * g + 0.114 * b + 0.5 + 1e-9);
}

TEST_F(ImageDecode, KindFollowsTheExtensionInAnyCase) {
  EXPECT_EQ(image_kind_of("a/b.PNG"), ImageKind::png);
  EXPECT_EQ(image_kind_of("b.TiFf"), ImageKind::tiff);
  EXPECT_EQ(image_kind_of("b.JPEG"), ImageKind::jpeg);
  EXPECT_FALSE(image_kind_of("png"));
  EXPECT_FALSE(image_kind_of("b.png.csv"));
}

TEST_F(ImageDecode, EveryExactSeedComesBackBitForBit) {
  for (const test::Seed& seed : test::image_seeds(folder_)) {
    if (!seed.exact) continue;
    Frame frame;
    const auto notes = read(file(seed.name, seed.bytes), frame);
    ASSERT_TRUE(notes) << notes.error().message;
    EXPECT_TRUE(test::same_pixels(frame.view(), seed.image)) << seed.name;
    EXPECT_EQ(frame.view().format.type == PixelType::mono16, seed.image.bits == 16) << seed.name;
    EXPECT_EQ(notes.value(), ImageNotes{}) << seed.name;
  }
}

TEST_F(ImageDecode, PgmDepthFollowsMaxval) {
  const auto depth = [&](int max_value) {
    Frame frame;
    const auto notes = read(
        file("d.pgm", test::encode_pgm(test::random_image(4, 3, 1, max_value), max_value)), frame);
    EXPECT_TRUE(notes) << notes.error().message;
    return frame.view().format.bit_depth;
  };
  EXPECT_EQ(depth(15), 8);
  EXPECT_EQ(depth(255), 8);
  EXPECT_EQ(depth(256), 10);
  EXPECT_EQ(depth(1023), 10);
  EXPECT_EQ(depth(1024), 12);
  EXPECT_EQ(depth(4095), 12);
  EXPECT_EQ(depth(16383), 14);
  EXPECT_EQ(depth(16384), 16);
  EXPECT_EQ(depth(65535), 16);
}

TEST_F(ImageDecode, OptionOverridesTheDepthOfWords) {
  const TestImage image = test::random_image(4, 3, 2, 4095);
  Frame frame;
  ASSERT_TRUE(read(file("d.pgm", test::encode_pgm(image, 65535)), frame, {.bit_depth = 12}));
  EXPECT_EQ(frame.view().format.bit_depth, 12);
  EXPECT_TRUE(test::same_pixels(frame.view(), image));
}

TEST_F(ImageDecode, ScaledPngGoesBackToTheCountsOfTheCamera) {
  const TestImage counts = test::random_image(6, 5, 3, 4095);
  TestImage shifted = counts;
  TestImage repeated = counts;
  for (auto& sample : shifted.samples) sample = static_cast<std::uint16_t>(sample << 4);
  for (auto& sample : repeated.samples)
    sample = static_cast<std::uint16_t>(sample << 4 | sample >> 8);
  for (const TestImage& stored : {shifted, repeated}) {
    Frame frame;
    const auto notes =
        read(file("s.png", test::encode_png(stored, {.significant_bits = 12})), frame);
    ASSERT_TRUE(notes) << notes.error().message;
    EXPECT_EQ(frame.view().format.bit_depth, 12);
    EXPECT_TRUE(test::same_pixels(frame.view(), counts));
  }
}

TEST_F(ImageDecode, PngWhoseWordsAreNotScaledNeedsTheDepth) {
  const TestImage counts = test::random_image(6, 5, 4, 4095);
  const auto path = file("s.png", test::encode_png(counts, {.significant_bits = 12}));
  EXPECT_NE(refusal(path).find("--bit-depth"), std::string::npos);
  Frame frame;
  ASSERT_TRUE(read(path, frame, {.bit_depth = 12}));
  EXPECT_TRUE(test::same_pixels(frame.view(), counts));
}

TEST_F(ImageDecode, ColourBecomesLuma) {
  for (const int max_value : {255, 65535}) {
    const TestImage image = test::random_image(7, 5, 5, max_value, 3);
    Frame frame;
    const auto notes = read(file("c.png", test::encode_png(image)), frame);
    ASSERT_TRUE(notes) << notes.error().message;
    EXPECT_TRUE(notes.value().colour);
    EXPECT_FALSE(notes.value().alpha);
    EXPECT_EQ(frame.view().at(2, 3),
              rec601(image.at(2, 3, 0), image.at(2, 3, 1), image.at(2, 3, 2)));
  }
  const TestImage image = test::random_image(7, 5, 6, 255, 3);
  Frame frame;
  ASSERT_TRUE(read(file("c.bmp", test::encode_bmp(image)), frame).value().colour);
  EXPECT_EQ(frame.view().at(2, 3), rec601(image.at(2, 3, 0), image.at(2, 3, 1), image.at(2, 3, 2)));
}

TEST_F(ImageDecode, PaletteBecomesLuma) {
  const TestImage image = test::random_image(7, 5, 7);
  Frame frame;
  ASSERT_TRUE(read(file("p.png", test::encode_palette_png(image)), frame).value().colour);
  const int i = image.at(2, 3);
  EXPECT_EQ(frame.view().at(2, 3), rec601(i, 255 - i, i / 2));
}

TEST_F(ImageDecode, AlphaIsIgnoredAndSaid) {
  const TestImage image = test::random_image(7, 5, 8, 255, 2);
  Frame frame;
  const auto notes = read(file("a.png", test::encode_png(image)), frame);
  ASSERT_TRUE(notes) << notes.error().message;
  EXPECT_TRUE(notes.value().alpha);
  EXPECT_FALSE(notes.value().colour);
  EXPECT_TRUE(test::same_pixels(frame.view(), image));
  const TestImage rgba = test::random_image(7, 5, 9, 255, 4);
  EXPECT_TRUE(read(file("a2.png", test::encode_png(rgba)), frame).value().alpha);
  EXPECT_TRUE(read(file("a.bmp", test::encode_bmp(rgba)), frame).value().alpha);
  EXPECT_EQ(frame.view().at(2, 3), rec601(rgba.at(2, 3, 0), rgba.at(2, 3, 1), rgba.at(2, 3, 2)));
}

TEST_F(ImageDecode, BmpMayBeStoredFromTheTopDown) {
  const TestImage image = test::random_image(7, 5, 10);
  Frame frame;
  ASSERT_TRUE(read(file("t.bmp", test::encode_bmp(image, true)), frame));
  EXPECT_TRUE(test::same_pixels(frame.view(), image));
}

TEST_F(ImageDecode, JpegIsCloseToItsSource) {
  TestImage image = test::random_image(32, 24, 11);
  for (int i = 0; i < 32 * 24; ++i)
    image.samples[static_cast<std::size_t>(i)] =
        static_cast<std::uint16_t>(i % 32 * 4 + i / 32 * 2);
  for (const bool progressive : {false, true}) {
    Frame frame;
    const auto notes = read(file("j.jpg", test::encode_jpeg(image, progressive)), frame);
    ASSERT_TRUE(notes) << notes.error().message;
    EXPECT_FALSE(notes.value().colour);
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 32; ++x) EXPECT_NEAR(frame.view().at(x, y), image.at(x, y), 6);
    }
  }
  const TestImage colour = test::random_image(16, 16, 12, 255, 3);
  Frame frame;
  EXPECT_TRUE(read(file("c.jpg", test::encode_jpeg(colour)), frame).value().colour);
}

TEST_F(ImageDecode, SizeAboveTheLimitIsRefused) {
  const TestImage image = test::random_image(13, 9, 13);
  for (const test::Seed& seed : test::image_seeds(folder_)) {
    const auto path = file(seed.name, seed.bytes);
    EXPECT_NE(refusal(path, {.max_pixels = 13 * 9 - 1}).find("limit"), std::string::npos);
    Frame frame;
    EXPECT_TRUE(read(path, frame, {.max_pixels = 13 * 9})) << seed.name;
  }
}

TEST_F(ImageDecode, TiffLayoutsThatMeanOtherThingsAreRefused) {
  const auto refused = [&](const char* name, const TestImage& image,
                           const test::TiffLayout& layout) {
    test::write_tiff(folder_ / name, {image}, layout);
    return refusal((folder_ / name).string());
  };
  const TestImage image = test::random_image(8, 8, 14);
  EXPECT_NE(refused("w.tif", image, {.photometric = 0}).find("MinIsWhite"), std::string::npos);
  EXPECT_NE(refused("s.tif", image, {.sample_format = 2}).find("signed"), std::string::npos);
  EXPECT_NE(refused("o.tif", image, {.orientation = 3}).find("Orientation"), std::string::npos);
  EXPECT_NE(refused("j.tif", image, {.compression = 7, .rows_per_strip = 8}).find("compression"),
            std::string::npos);
  EXPECT_NE(refused("c.tif", test::random_image(8, 8, 15, 255, 3), {}).find("colour"),
            std::string::npos);
}

TEST_F(ImageDecode, TiffDepthFollowsMaxSampleValue) {
  const TestImage image = test::random_image(8, 8, 16, 1023);
  test::write_tiff(folder_ / "m.tif", {image}, {.max_sample_value = 1023});
  Frame frame;
  ASSERT_TRUE(read((folder_ / "m.tif").string(), frame));
  EXPECT_EQ(frame.view().format.bit_depth, 10);
  test::write_tiff(folder_ / "n.tif", {image}, {});
  ASSERT_TRUE(read((folder_ / "n.tif").string(), frame));
  EXPECT_EQ(frame.view().format.bit_depth, 16);
}

TEST_F(ImageDecode, SeveralPagesAreNotOneImage) {
  const TestImage image = test::random_image(8, 8, 17);
  test::write_tiff(folder_ / "two.tif", {image, image});
  EXPECT_NE(refusal((folder_ / "two.tif").string()).find("alone"), std::string::npos);
}

}  // namespace
}  // namespace lsv
