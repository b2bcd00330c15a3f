// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/frame_source.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "tests/support/test_images.h"

namespace lsv {
namespace {

using test::TestImage;

class FrameSourceTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = test::fresh_folder(testing::TempDir(), std::string("source_") + info->name());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string numbered_file(const char* stem, int number) {
    std::string name = stem;
    name += std::to_string(number);
    return frame_file(name + ".pgm", number);
  }

  /// A PGM whose first pixel is `mark`.
  std::string frame_file(const std::string& name, int mark, int width_px = 6) {
    TestImage image = test::random_image(width_px, 4, 1);
    image.samples[0] = static_cast<std::uint16_t>(mark);
    test::write_bytes(folder_ / name, test::encode_pgm(image, 255));
    return path(name);
  }

  std::string text_file(const std::string& name, const std::string& text) {
    test::write_bytes(folder_ / name, test::bytes_of(text));
    return path(name);
  }

  std::filesystem::path folder_;
};

struct Seen {
  std::int64_t index;
  int mark;
  std::int64_t ns;
  friend bool operator==(const Seen&, const Seen&) = default;
  friend void PrintTo(const Seen& seen, std::ostream* out) {
    *out << "{index " << seen.index << ", mark " << seen.mark << ", ns " << seen.ns << "}";
  }
};

struct Reading {
  SourceInfo info;
  std::vector<Seen> seen;
  std::optional<Error> error;
};

Reading read_frames(const std::vector<std::string>& paths, const SourceOptions& options) {
  Reading out;
  auto source = open_frames(paths, options);
  if (!source) {
    out.error = source.error();
    return out;
  }
  out.info = source.value()->info();
  Frame frame;
  for (;;) {
    const auto got = source.value()->next(frame);
    if (!got) out.error = got.error();
    if (!got || !got.value()) break;
    out.seen.push_back({frame.index, frame.view().at(0, 0), frame.stamp.ns});
  }
  return out;
}

const SourceOptions kNoTime{.need_time = false};

void expect_error(const Reading& result, ErrorCode code, const std::string& part) {
  ASSERT_TRUE(result.error) << "expected an error with: " << part;
  EXPECT_EQ(result.error->code, code) << result.error->message;
  EXPECT_NE(result.error->message.find(part), std::string::npos) << result.error->message;
}

TEST_F(FrameSourceTest, FolderIsReadInNaturalOrder) {
  for (const int i : {10, 2, 1, 9, 3, 4, 5, 6, 7, 8})
    frame_file(std::string("img").append(std::to_string(i)) + ".PGM", i);
  text_file("notes.txt", "not a frame");
  const Reading result = read_frames({folder_.string()}, kNoTime);
  ASSERT_FALSE(result.error) << result.error->message;
  ASSERT_EQ(result.seen.size(), 10U);
  for (std::int64_t i = 0; i < 10; ++i)
    EXPECT_EQ(result.seen[static_cast<std::size_t>(i)], (Seen{i, static_cast<int>(i + 1), i}));
  EXPECT_EQ(result.info.description, "PGM sequence");
  EXPECT_EQ(result.info.frame_count, 10);
  EXPECT_TRUE(result.info.warnings.empty());
}

TEST_F(FrameSourceTest, PatternAndShellListGiveTheSame) {
  const std::vector<std::string> listed = {frame_file("a1.pgm", 1), frame_file("a10.pgm", 10),
                                           frame_file("a2.pgm", 2)};
  frame_file("b1.pgm", 99);
  const Reading by_pattern = read_frames({path("a*.pgm")}, kNoTime);
  const Reading by_list = read_frames(listed, kNoTime);
  EXPECT_EQ(by_pattern.seen, (std::vector<Seen>{{0, 1, 0}, {1, 2, 1}, {9, 10, 9}}));
  EXPECT_EQ(by_list.seen, by_pattern.seen);
}

TEST_F(FrameSourceTest, ListThatIsNoFamilyKeepsItsOrder) {
  const Reading result =
      read_frames({frame_file("ref.pgm", 7), frame_file("def_05.pgm", 5)}, kNoTime);
  EXPECT_EQ(result.seen, (std::vector<Seen>{{0, 7, 0}, {1, 5, 1}}));
}

TEST_F(FrameSourceTest, IgnoredNumbersKeepTheGivenOrder) {
  SourceOptions options = kNoTime;
  options.ignore_numbers = true;
  const Reading result = read_frames({frame_file("a9.pgm", 9), frame_file("a2.pgm", 2)}, options);
  EXPECT_EQ(result.seen, (std::vector<Seen>{{0, 9, 0}, {1, 2, 1}}));
  EXPECT_TRUE(result.info.warnings.empty());
}

TEST_F(FrameSourceTest, AHoleInTheNumbersIsMissingTime) {
  for (const int i : {100, 101, 104, 105, 108}) numbered_file("f_", i);
  const Reading result = read_frames({folder_.string()}, {.rate_hz = 1000.0});
  EXPECT_EQ(result.seen, (std::vector<Seen>{{0, 100, 0},
                                            {1, 101, 1'000'000},
                                            {4, 104, 4'000'000},
                                            {5, 105, 5'000'000},
                                            {8, 108, 8'000'000}}));
  EXPECT_EQ(result.info.missing_count, 4);
  ASSERT_EQ(result.info.warnings.size(), 1U);
  const std::string& warning = result.info.warnings.front();
  EXPECT_NE(warning.find("4 frames are missing"), std::string::npos) << warning;
  EXPECT_NE(warning.find("f_101.pgm and f_104.pgm"), std::string::npos) << warning;
  EXPECT_EQ(result.info.last_stamp->ns, 8'000'000);
}

TEST_F(FrameSourceTest, AConstantStepIsSaid) {
  for (const int i : {0, 10, 20, 30}) numbered_file("f", i);
  const Reading result = read_frames({folder_.string()}, kNoTime);
  EXPECT_EQ(result.info.missing_count, 27);
  ASSERT_EQ(result.info.warnings.size(), 1U);
  EXPECT_NE(result.info.warnings.front().find("step by 10"), std::string::npos);
  EXPECT_NE(result.info.warnings.front().find("--ignore-numbers"), std::string::npos);
  ASSERT_EQ(result.seen.size(), 4U);
  EXPECT_EQ(result.seen.back().index, 30);
}

TEST_F(FrameSourceTest, TwoFilesWithOneNumberAreAnError) {
  frame_file("f1.pgm", 1);
  frame_file("f01.pgm", 1);
  expect_error(read_frames({folder_.string()}, kNoTime), ErrorCode::bad_input, "same frame number");
}

TEST_F(FrameSourceTest, MixedAndEmptyFoldersSayWhatToDo) {
  expect_error(read_frames({folder_.string()}, kNoTime), ErrorCode::bad_input, "pattern");
  frame_file("a1.pgm", 1);
  test::write_bytes(folder_ / "a2.png", test::encode_png(test::random_image(6, 4, 1)));
  expect_error(read_frames({folder_.string()}, kNoTime), ErrorCode::invalid_argument, "pattern");
}

TEST_F(FrameSourceTest, NothingThereIsNamed) {
  expect_error(read_frames({path("none.png")}, kNoTime), ErrorCode::bad_input, "none.png");
  expect_error(read_frames({path("none*.png")}, kNoTime), ErrorCode::bad_input, "none*.png");
  expect_error(read_frames({}, kNoTime), ErrorCode::invalid_argument, "no frames");
  expect_error(read_frames({""}, kNoTime), ErrorCode::invalid_argument, "no frames");
  expect_error(read_frames({text_file("a.xyz", "?")}, kNoTime), ErrorCode::unsupported, "a.xyz");
}

TEST_F(FrameSourceTest, SpecialFilesNeitherHangNorPass) {
  ASSERT_EQ(::mkfifo(path("pipe.png").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo(path("pipe.raw").c_str(), 0600), 0);
  std::filesystem::create_directory(folder_ / "folder.tif");
  expect_error(read_frames({path("pipe.png")}, kNoTime), ErrorCode::bad_input, "named pipe");
  SourceOptions raw = kNoTime;
  raw.raw = parse_raw_format("4x4:mono8").value();
  expect_error(read_frames({path("pipe.raw")}, raw), ErrorCode::bad_input, "named pipe");
  expect_error(read_frames({path("folder.tif"), path("folder.tif")}, kNoTime), ErrorCode::bad_input,
               "a directory");
  std::filesystem::create_symlink("/dev/zero", folder_ / "zero.pgm");
  expect_error(read_frames({path("zero.pgm")}, kNoTime), ErrorCode::bad_input, "a device");
}

TEST_F(FrameSourceTest, AHugeFileIsRefusedUnread) {
  std::ofstream(path("big.png")).put('x');
  std::filesystem::resize_file(path("big.png"), std::uintmax_t{10} << 30);  // sparse
  expect_error(read_frames({path("big.png")}, kNoTime), ErrorCode::bad_input, "10737418240 bytes");
}

TEST_F(FrameSourceTest, EveryFrameMustHaveTheFirstFormat) {
  frame_file("a1.pgm", 1);
  frame_file("a2.pgm", 2);
  frame_file("a3.pgm", 3, 7);
  const Reading result = read_frames({folder_.string()}, kNoTime);
  EXPECT_EQ(result.seen.size(), 2U);
  expect_error(result, ErrorCode::bad_input, "a3.pgm");
  expect_error(result, ErrorCode::bad_input, "7 x 4");
  expect_error(result, ErrorCode::bad_input, "6 x 4");
}

TEST_F(FrameSourceTest, ColourAmongGreyIsAnError) {
  test::write_bytes(folder_ / "a1.png", test::encode_png(test::random_image(6, 4, 1)));
  test::write_bytes(folder_ / "a2.png", test::encode_png(test::random_image(6, 4, 1, 255, 3)));
  const Reading result = read_frames({folder_.string()}, kNoTime);
  EXPECT_EQ(result.seen.size(), 1U);
  expect_error(result, ErrorCode::bad_input, "a2.png");
}

TEST_F(FrameSourceTest, ColourAndJpegAreSaidOnce) {
  const TestImage colour = test::random_image(16, 16, 1, 255, 3);
  for (const char* name : {"a1.jpg", "a2.jpg"})
    test::write_bytes(folder_ / name, test::encode_jpeg(colour));
  const Reading result = read_frames({folder_.string()}, kNoTime);
  ASSERT_EQ(result.info.warnings.size(), 2U);
  EXPECT_NE(result.info.warnings[0].find("luma"), std::string::npos);
  EXPECT_NE(result.info.warnings[1].find("lossy"), std::string::npos);
}

TEST_F(FrameSourceTest, RoiIsCutOutAndChecked) {
  const TestImage image = test::random_image(9, 7, 3);
  test::write_bytes(folder_ / "a.pgm", test::encode_pgm(image, 255));
  SourceOptions options = kNoTime;
  options.roi = Roi{.x_px = 2, .y_px = 3, .width_px = 7, .height_px = 4};
  auto source = open_frames({path("a.pgm")}, options);
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ(source.value()->info().format.width_px, 7);
  EXPECT_EQ(source.value()->info().whole_format.width_px, 9);
  EXPECT_EQ(source.value()->info().whole_format.height_px, 7);
  Frame frame;
  ASSERT_TRUE(source.value()->next(frame).value());
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 7; ++x) EXPECT_EQ(frame.view().at(x, y), image.at(x + 2, y + 3));
  }
  options.roi->width_px = 8;
  expect_error(read_frames({path("a.pgm")}, options), ErrorCode::invalid_argument, "9 x 7");
}

TEST_F(FrameSourceTest, SelectionWorksOnIndices) {
  for (const int i : {1, 2, 3, 5, 6, 7, 8, 9}) numbered_file("f", i);
  SourceOptions options = kNoTime;
  options.start = 1;
  options.stop = 8;
  options.step = 2;  // indices 1, 3 (missing), 5, 7
  const Reading result = read_frames({folder_.string()}, options);
  EXPECT_EQ(result.seen, (std::vector<Seen>{{1, 2, 1}, {5, 6, 5}, {7, 8, 7}}));
  EXPECT_EQ(result.info.frame_count, 3);
}

TEST_F(FrameSourceTest, SelectionOutsideIsAUsageError) {
  frame_file("f1.pgm", 1);
  frame_file("f2.pgm", 2);
  const auto with = [&](std::int64_t start, std::optional<std::int64_t> stop, std::int64_t step) {
    SourceOptions options = kNoTime;
    options.start = start;
    options.stop = stop;
    options.step = step;
    return read_frames({folder_.string()}, options);
  };
  expect_error(with(-1, {}, 1), ErrorCode::invalid_argument, "--start");
  expect_error(with(0, {}, 0), ErrorCode::invalid_argument, "--step");
  expect_error(with(0, {}, -1), ErrorCode::invalid_argument, "--step");
  expect_error(with(1, 1, 1), ErrorCode::invalid_argument, "--stop");
  expect_error(with(2, {}, 1), ErrorCode::invalid_argument, "0 to 1");
}

TEST_F(FrameSourceTest, TimeBaseMustBeGivenOnce) {
  const std::string frame = frame_file("f1.pgm", 1);
  const std::string stamps = text_file("t.csv", "time_s\n0\n");
  const Reading none = read_frames({frame}, {});
  expect_error(none, ErrorCode::invalid_argument, "no default frame rate");
  expect_error(none, ErrorCode::invalid_argument, "--rate-hz");
  expect_error(none, ErrorCode::invalid_argument, "--timestamps");
  expect_error(read_frames({frame}, {.rate_hz = 1.0, .timestamps_path = stamps}),
               ErrorCode::invalid_argument, "both");
  for (const double rate : {0.0, -1.0, std::nan(""), HUGE_VAL, 2e9})
    expect_error(read_frames({frame}, {.rate_hz = rate}), ErrorCode::invalid_argument, "--rate-hz");
}

TEST_F(FrameSourceTest, RateDoesNotDriftOverLongRuns) {
  // 30000/1001 Hz at index 10^9: the exact stamp is index * 1001 / 30000 s.
  frame_file("f0.pgm", 0);
  frame_file("f1000000000.pgm", 1);
  const Reading result = read_frames({folder_.string()}, {.rate_hz = 30.0});
  ASSERT_EQ(result.seen.size(), 2U);
  EXPECT_EQ(result.seen[1].ns, 33'333'333'333'333'333);
}

TEST_F(FrameSourceTest, StampsRoundToNearest) {
  for (int i = 0; i < 4; ++i) numbered_file("f", i);
  const Reading result = read_frames({folder_.string()}, {.rate_hz = 3.0});
  EXPECT_EQ(result.seen[1].ns, 333'333'333);
  EXPECT_EQ(result.seen[2].ns, 666'666'667);
  EXPECT_EQ(result.seen[3].ns, 1'000'000'000);
}

TEST_F(FrameSourceTest, ASlowRateNeverOverflows) {
  frame_file("f0.pgm", 0);
  frame_file("f999999999999999999.pgm", 1);
  expect_error(read_frames({folder_.string()}, {.rate_hz = 1.0}), ErrorCode::invalid_argument,
               "146 years");
}

TEST_F(FrameSourceTest, StampsBelongToFilesInTheirOrder) {
  for (int i = 0; i < 3; ++i) numbered_file("f", i);
  const std::string stamps = text_file("t.csv", "time_s\n10\n10.5\n12\n");
  const Reading result = read_frames({folder_.string()}, {.timestamps_path = stamps});
  EXPECT_EQ(
      result.seen,
      (std::vector<Seen>{{0, 0, 10'000'000'000}, {1, 1, 10'500'000'000}, {2, 2, 12'000'000'000}}));
}

TEST_F(FrameSourceTest, StampsWithoutNumbersSkipMissingFiles) {
  for (const int i : {0, 1, 4}) numbered_file("f", i);
  const std::string one_per_file = text_file("t.csv", "time_s\n0\n1\n4\n");
  EXPECT_EQ(read_frames({folder_.string()}, {.timestamps_path = one_per_file}).seen,
            (std::vector<Seen>{{0, 0, 0}, {1, 1, 1'000'000'000}, {4, 4, 4'000'000'000}}));
  const std::string one_per_trigger = text_file("u.csv", "time_s\n0\n1\n2\n3\n4\n");
  expect_error(read_frames({folder_.string()}, {.timestamps_path = one_per_trigger}),
               ErrorCode::bad_input, "frame");
}

TEST_F(FrameSourceTest, StampsWithNumbersFollowTheIndex) {
  for (const int i : {7, 8, 11}) numbered_file("f", i);
  const std::string stamps =
      text_file("t.csv", "frame,time_ns\n0,100\n1,200\n2,300\n3,400\n4,500\n");
  EXPECT_EQ(read_frames({folder_.string()}, {.timestamps_path = stamps}).seen,
            (std::vector<Seen>{{0, 7, 100}, {1, 8, 200}, {4, 11, 500}}));
  const std::string hole = text_file("u.csv", "frame,time_ns\n0,100\n4,500\n");
  const Reading result = read_frames({folder_.string()}, {.timestamps_path = hole});
  EXPECT_EQ(result.seen.size(), 1U);
  expect_error(result, ErrorCode::bad_input, "frame 1");
}

TEST_F(FrameSourceTest, SelectionKeepsTheStampsOfTheFrames) {
  for (int i = 0; i < 5; ++i) numbered_file("f", i);
  const std::string stamps = text_file("t.csv", "time_ns\n10\n11\n12\n13\n14\n");
  EXPECT_EQ(
      read_frames({folder_.string()}, {.timestamps_path = stamps, .start = 1, .step = 2}).seen,
      (std::vector<Seen>{{1, 1, 11}, {3, 3, 13}}));
}

TEST_F(FrameSourceTest, TooFewStampsAreRefusedBeforeTheRun) {
  for (int i = 0; i < 3; ++i) numbered_file("f", i);
  const std::string stamps = text_file("t.csv", "time_s\n0\n1\n");
  const Reading result = read_frames({folder_.string()}, {.timestamps_path = stamps});
  EXPECT_TRUE(result.seen.empty());
  expect_error(result, ErrorCode::bad_input, "frame 2");
}

TEST_F(FrameSourceTest, TooManyStampsAreSaid) {
  frame_file("f0.pgm", 0);
  const Reading result =
      read_frames({folder_.string()}, {.timestamps_path = text_file("t.csv", "time_s\n0\n1\n")});
  ASSERT_EQ(result.info.warnings.size(), 1U);
  EXPECT_NE(result.info.warnings.front().find("2 stamps for 1 frame"), std::string::npos);
}

TEST_F(FrameSourceTest, RawFileWithHeader) {
  test::Bytes bytes(10, 0xEE);
  for (int i = 0; i < 3 * 12; ++i) bytes.push_back(static_cast<std::uint8_t>(i));
  test::write_bytes(folder_ / "r.raw", bytes);
  SourceOptions options = kNoTime;
  options.raw = parse_raw_format("4x3:mono8:10").value();
  EXPECT_EQ(read_frames({path("r.raw")}, options).seen,
            (std::vector<Seen>{{0, 0, 0}, {1, 12, 1}, {2, 24, 2}}));
  options.start = 2;
  EXPECT_EQ(read_frames({path("r.raw")}, options).seen, (std::vector<Seen>{{2, 24, 2}}));
}

TEST_F(FrameSourceTest, RawWordsAreLittleEndian) {
  test::write_bytes(folder_ / "r.y16", {0x34, 0x02, 0xFF, 0x03});
  SourceOptions options = kNoTime;
  options.raw = parse_raw_format("2x1:mono10").value();
  auto source = open_frames({path("r.y16")}, options);
  ASSERT_TRUE(source) << source.error().message;
  Frame frame;
  ASSERT_TRUE(source.value()->next(frame).value());
  EXPECT_EQ(frame.view().at(0, 0), 0x234);
  EXPECT_EQ(frame.view().at(1, 0), 0x3FF);
  EXPECT_EQ(frame.view().format.bit_depth, 10);
}

TEST_F(FrameSourceTest, RawWordsAboveTheirDepthAreAnError) {
  test::write_bytes(folder_ / "r.y16", {0, 0, 0x00, 0x04});
  SourceOptions options = kNoTime;
  options.raw = parse_raw_format("2x1:mono10").value();
  expect_error(read_frames({path("r.y16")}, options), ErrorCode::bad_input, "1024");
}

TEST_F(FrameSourceTest, RawMustBeWhole) {
  test::write_bytes(folder_ / "r.raw", test::Bytes(30, 1));
  SourceOptions options = kNoTime;
  options.raw = parse_raw_format("4x3:mono8").value();
  expect_error(read_frames({path("r.raw")}, options), ErrorCode::bad_input, "frame 2");
  expect_error(read_frames({path("r.raw")}, kNoTime), ErrorCode::invalid_argument,
               "--raw 640x480:mono8");
  test::write_bytes(folder_ / "empty.raw", {});
  expect_error(read_frames({path("empty.raw")}, options), ErrorCode::bad_input, "no frame");
}

TEST_F(FrameSourceTest, RawIsForcedOnAnyExtension) {
  test::write_bytes(folder_ / "r.png", test::Bytes(12, 5));
  SourceOptions options = kNoTime;
  options.raw = parse_raw_format("4x3:mono8").value();
  EXPECT_EQ(read_frames({path("r.png")}, options).seen, (std::vector<Seen>{{0, 5, 0}}));
}

/// Standard input taken from a pipe that holds `bytes`, for the life of the object.
class PipedInput {
 public:
  explicit PipedInput(const test::Bytes& bytes) : saved_(::dup(STDIN_FILENO)) {
    int ends[2] = {-1, -1};
    EXPECT_EQ(::pipe(ends), 0);
    EXPECT_EQ(::write(ends[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    ::close(ends[1]);
    ::dup2(ends[0], STDIN_FILENO);
    ::close(ends[0]);
  }
  ~PipedInput() {
    ::dup2(saved_, STDIN_FILENO);
    ::close(saved_);
  }

 private:
  int saved_;
};

TEST_F(FrameSourceTest, StandardInputIsReadToItsEnd) {
  SourceOptions options{.rate_hz = 100.0, .raw = parse_raw_format("4x3:mono8:5").value()};
  test::Bytes bytes(5, 0xEE);
  for (int i = 0; i < 24; ++i) bytes.push_back(static_cast<std::uint8_t>(i));
  const PipedInput piped(bytes);
  const Reading result = read_frames({"-"}, options);
  ASSERT_FALSE(result.error) << result.error->message;
  EXPECT_EQ(result.seen, (std::vector<Seen>{{0, 0, 0}, {1, 12, 10'000'000}}));
  EXPECT_FALSE(result.info.frame_count);
}

TEST_F(FrameSourceTest, StandardInputThatEndsInAFrameIsAnError) {
  SourceOptions options = kNoTime;
  options.raw = parse_raw_format("4x3:mono8").value();
  {
    const PipedInput piped(test::Bytes(30, 9));
    const Reading result = read_frames({"-"}, options);
    EXPECT_EQ(result.seen.size(), 2U);
    expect_error(result, ErrorCode::bad_input, "frame 2");
  }
  {
    const PipedInput piped({});
    expect_error(read_frames({"-"}, options), ErrorCode::bad_input, "standard input");
  }
  expect_error(read_frames({"-"}, kNoTime), ErrorCode::invalid_argument, "--raw");
}

TEST_F(FrameSourceTest, FramesReuseTheirMemory) {
  for (int i = 0; i < 6; ++i) numbered_file("f", i);
  SourceOptions options = kNoTime;
  options.roi = Roi{.x_px = 0, .y_px = 0, .width_px = 2, .height_px = 2};
  auto source = open_frames({folder_.string()}, options);
  ASSERT_TRUE(source) << source.error().message;
  Frame frame;
  ASSERT_TRUE(source.value()->next(frame).value());
  const std::byte* pixels = frame.view().data;
  while (source.value()->next(frame).value()) EXPECT_EQ(frame.view().data, pixels);
}

TEST_F(FrameSourceTest, BitDepthSpeaksOfWords) {
  for (const int depth : {8, 9, 0, -1, 17}) {
    SourceOptions options = kNoTime;
    options.bit_depth = depth;
    expect_error(read_frames({frame_file("f.pgm", 1)}, options), ErrorCode::invalid_argument,
                 "--bit-depth");
  }
}

TEST(RawFormatText, IsStrict) {
  const auto good = parse_raw_format("640x480:mono12:1024");
  ASSERT_TRUE(good);
  EXPECT_EQ(
      good.value().format,
      (FrameFormat{.width_px = 640, .height_px = 480, .type = PixelType::mono16, .bit_depth = 12}));
  EXPECT_EQ(good.value().header_bytes, 1024);
  EXPECT_EQ(parse_raw_format("1x1:mono8").value().format.type, PixelType::mono8);
  for (const char* text : {"",
                           "640x480",
                           "640:mono8",
                           "x:mono8",
                           "0x1:mono8",
                           "1x0:mono8",
                           "-1x1:mono8",
                           "1x1:mono9",
                           "1x1:mono",
                           "1x1:rgb8",
                           "1x1:mono8:",
                           "1x1:mono8:-1",
                           "1x1:mono8:1:1",
                           "1x1x1:mono8",
                           "+1x1:mono8",
                           " 1x1:mono8",
                           "1x1:mono8 ",
                           "99999999999x1:mono8",
                           "1x1:mono8:99999999999999999999",
                           "1x1:mono08"}) {
    const auto result = parse_raw_format(text);
    ASSERT_FALSE(result) << text;
    EXPECT_EQ(result.error().code, ErrorCode::invalid_argument);
  }
}

TEST(RoiText, IsStrict) {
  EXPECT_EQ(parse_roi("1,2,3,4").value(),
            (Roi{.x_px = 1, .y_px = 2, .width_px = 3, .height_px = 4}));
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "-1,2,3,4", "1,2,0,4", "1,2,3,-4", "a,b,c,d",
                           "1, 2,3,4", "1,2,3,99999999999"})
    EXPECT_FALSE(parse_roi(text)) << text;
}

}  // namespace
}  // namespace lsv
