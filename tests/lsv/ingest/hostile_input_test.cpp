// SPDX-License-Identifier: BSD-3-Clause
// Broken input of every kind: no crash, no hang, an error that names the file, and never a part
// of a frame handed out as a whole one.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <iostream>
#include <random>

#include "lsv/ingest/frame_source.h"
#include "lsv/ingest/timestamps.h"
#include "tests/support/hostile_files.h"

namespace lsv {
namespace {

using test::HostileFile;
using test::HostileRole;

struct Outcome {
  std::optional<Error> error;
  std::int64_t frames = 0;
  bool exact = true;  // every frame delivered equals `truth`
};

Outcome read_all(const std::string& path, const SourceOptions& options,
                 const test::TestImage* truth = nullptr) {
  Outcome out;
  auto source = open_frames({path}, options);
  if (!source) {
    out.error = source.error();
    return out;
  }
  Frame frame;
  for (;;) {
    const auto got = source.value()->next(frame);
    if (!got) out.error = got.error();
    if (!got || !got.value()) return out;
    ++out.frames;
    if (truth != nullptr) out.exact = out.exact && test::same_pixels(frame.view(), *truth);
  }
}

SourceOptions options_of(const HostileFile& file) {
  SourceOptions options{.need_time = false};
  if (file.args.size() == 2) {
    const auto raw = parse_raw_format(file.args[1]);
    if (raw) options.raw = raw.value();
  }
  return options;
}

class HostileInput : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = test::fresh_folder(testing::TempDir(), std::string("hostile_") + info->name());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const test::Bytes& bytes) {
    test::write_bytes(folder_ / name, bytes);
    return (folder_ / name).string();
  }

  std::filesystem::path folder_;
};

TEST_F(HostileInput, TheWholeSetIsRefusedByName) {
  for (const HostileFile& file : test::write_hostile_set(folder_)) {
    if (file.role != HostileRole::frames) continue;
    const Outcome outcome = read_all(file.path.string(), options_of(file));
    ASSERT_TRUE(outcome.error) << file.path.filename() << ": " << file.what;
    EXPECT_EQ(outcome.frames, 0) << file.path.filename();
    const std::string& message = outcome.error->message;
    EXPECT_NE(message.find(file.path.filename().string()), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST_F(HostileInput, TimestampTables) {
  for (const HostileFile& file : test::write_hostile_set(folder_)) {
    if (file.role != HostileRole::timestamps) continue;
    const auto table = read_timestamps(file.path.string());
    EXPECT_EQ(table.ok(), file.valid) << file.path.filename() << ": " << file.what;
    if (table) continue;
    EXPECT_NE(table.error().message.find(file.path.filename().string()), std::string::npos)
        << table.error().message;
  }
}

TEST_F(HostileInput, MemoryStaysBounded) {
  for (const HostileFile& file : test::write_hostile_set(folder_)) {
    if (file.role == HostileRole::frames) (void)read_all(file.path.string(), options_of(file));
  }
  rusage usage{};
  ASSERT_EQ(::getrusage(RUSAGE_SELF, &usage), 0);
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "AddressSanitizer keeps freed memory";
#else
  // The generator itself holds 64 MiB and more for the text bomb.
  EXPECT_LT(usage.ru_maxrss, 512L * 1024) << "KiB";
#endif
}

TEST_F(HostileInput, CutAtEveryByteIsNeverAPartOfAFrame) {
  for (const test::Seed& seed : test::image_seeds(folder_)) {
    std::size_t whole = 0;
    Frame reference;
    {
      auto source = open_frames({write(seed.name, seed.bytes)}, {.need_time = false});
      ASSERT_TRUE(source) << source.error().message;
      ASSERT_TRUE(source.value()->next(reference).value());
    }
    test::TestImage truth{.width_px = reference.view().width_px(),
                          .height_px = reference.view().height_px(),
                          .samples = {}};
    for (int y = 0; y < truth.height_px; ++y) {
      for (int x = 0; x < truth.width_px; ++x)
        truth.samples.push_back(static_cast<std::uint16_t>(reference.view().at(x, y)));
    }
    for (std::size_t keep = 0; keep < seed.bytes.size(); ++keep) {
      const test::Bytes cut(seed.bytes.begin(),
                            seed.bytes.begin() + static_cast<std::ptrdiff_t>(keep));
      const Outcome outcome = read_all(write(seed.name, cut), {.need_time = false}, &truth);
      if (outcome.error) {
        EXPECT_NE(outcome.error->message.find(seed.name), std::string::npos)
            << outcome.error->message;
      } else {
        ++whole;
      }
      ASSERT_TRUE(outcome.exact) << seed.name << " cut at " << keep << " of " << seed.bytes.size();
    }
    RecordProperty(seed.name, static_cast<int>(whole));
    // The checksum of a PNG's empty end chunk covers nothing.
    EXPECT_LE(whole, 4U) << seed.name << ": only what lies behind the pixels may be missing";
  }
}

TEST_F(HostileInput, CutStackNeverDeliversAPartOfAPage) {
  const auto path = folder_ / "stack.tif";
  const test::TestImage page = test::random_image(9, 5, 21);
  test::write_tiff(path, {page, page, page}, {.compression = 5});
  const test::Bytes whole = test::read_bytes(path);
  for (std::size_t keep = 0; keep < whole.size(); ++keep) {
    test::write_bytes(
        path, test::Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(keep)));
    const Outcome outcome = read_all(path.string(), {.need_time = false}, &page);
    ASSERT_TRUE(outcome.error) << keep;
    EXPECT_NE(outcome.error->message.find("stack.tif"), std::string::npos);
    ASSERT_TRUE(outcome.exact) << keep;
  }
}

TEST_F(HostileInput, FlippedBytesNeverCrash) {
  constexpr std::uint32_t kSeed = 20240229;
  std::cout << "seed " << kSeed << "\n";
  std::mt19937 random(kSeed);
  for (const test::Seed& seed : test::image_seeds(folder_)) {
    for (int trial = 0; trial < 300; ++trial) {
      test::Bytes bytes = seed.bytes;
      const auto flips = 1 + random() % 4;
      for (std::uint32_t i = 0; i < flips; ++i)
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      // A small limit keeps the run short when a flip makes the image large.
      const Outcome outcome =
          read_all(write(seed.name, bytes), {.need_time = false, .max_pixels = 1 << 20});
      if (outcome.error) {
        EXPECT_NE(outcome.error->message.find(seed.name), std::string::npos)
            << outcome.error->message;
      } else {
        EXPECT_GT(outcome.frames, 0);
      }
    }
  }
}

}  // namespace
}  // namespace lsv
