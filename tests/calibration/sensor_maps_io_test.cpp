// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/sensor_maps_io.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "calibration/sensor_format.h"
#include "calibration/sha256.h"

namespace lsv {
namespace {

SensorMaps some_maps(int width_px = 13, int height_px = 7) {
  SensorMaps out{.width_px = width_px, .height_px = height_px};
  for (int i = 0; i < width_px * height_px; ++i) {
    out.offset_counts.push_back(15.0F + 0.37F * static_cast<float>(i % 11));
    out.gain_ratio.push_back(0.9F + 0.001F * static_cast<float>(i));
    out.defect.push_back(i % 10 == 3 ? 1 : 0);
  }
  return out;
}

/// A folder with a calibration that names its maps.
class SensorMapsFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("lsv_maps_" + std::to_string(::getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    calibration_.format = SensorFormat{.width_px = 13, .height_px = 7, .bit_depth = 8};
    write(sensor_maps_tiff(some_maps()).value());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string calibration_path() const { return (folder_ / "calibration.toml").string(); }
  std::string maps_path() const { return (folder_ / "maps.tif").string(); }

  /// With the digest of these bytes in the calibration.
  void write(const std::string& bytes) {
    std::ofstream(maps_path(), std::ios::binary) << bytes;
    calibration_.maps = MapsRecord{.file = "maps.tif", .sha256 = sha256_hex(bytes)};
  }
  auto load() const { return load_sensor_maps(calibration_, calibration_path()); }

  void expect_refusal(const std::string& says, const std::string& names) const {
    const auto loaded = load();
    ASSERT_FALSE(loaded) << says;
    EXPECT_EQ(loaded.error().code, ErrorCode::bad_input);
    EXPECT_NE(loaded.error().message.find(says), std::string::npos) << loaded.error().message;
    EXPECT_EQ(loaded.error().message.rfind(names, 0), 0U) << loaded.error().message;
    EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos) << loaded.error().message;
  }

  std::filesystem::path folder_;
  Calibration calibration_;
};

TEST_F(SensorMapsFile, ReadsBackWhatWasWritten) {
  const auto loaded = load();
  ASSERT_TRUE(loaded) << loaded.error().message;
  const SensorMaps expected = some_maps();
  EXPECT_EQ(loaded.value()->width_px, 13);
  EXPECT_EQ(loaded.value()->height_px, 7);
  EXPECT_EQ(loaded.value()->offset_counts, expected.offset_counts);
  EXPECT_EQ(loaded.value()->gain_ratio, expected.gain_ratio);
  EXPECT_EQ(loaded.value()->defect, expected.defect);
  EXPECT_EQ(sensor_maps_tiff(expected).value(), sensor_maps_tiff(expected).value());
}

TEST_F(SensorMapsFile, WithoutMapsThereAreNone) {
  calibration_.maps.reset();
  const auto loaded = load();
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded.value(), nullptr);
  EXPECT_EQ(sensor_maps_path(calibration_, calibration_path()), "");
}

TEST_F(SensorMapsFile, AMissingOrChangedFileIsRefused) {
  std::string bytes = sensor_maps_tiff(some_maps()).value();
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(maps_path(), std::ios::binary) << bytes;
  expect_refusal("SHA-256 differs", maps_path());
  std::filesystem::remove(maps_path());
  expect_refusal("no such sensor maps file (named by [maps] of " + calibration_path(), maps_path());
  std::filesystem::create_directory(maps_path());
  expect_refusal("is a folder, not a sensor maps file", maps_path());
}

TEST_F(SensorMapsFile, AFileLargerThanItsMapsIsNotRead) {
  write(sensor_maps_tiff(some_maps()).value() + std::string(std::size_t{2} << 20, 'x'));
  expect_refusal("larger than", maps_path());
}

TEST_F(SensorMapsFile, TheFormatMustAgree) {
  calibration_.format->height_px = 8;
  expect_refusal("holds maps of 13 x 7 px, but [format]", maps_path());
  calibration_.format.reset();
  expect_refusal("[maps] needs the section [format]", calibration_path());
}

TEST_F(SensorMapsFile, EveryCutIsRefused) {
  const std::string whole = sensor_maps_tiff(some_maps()).value();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const Result<SensorMaps> maps = parse_sensor_maps(whole.substr(0, length), "maps.tif");
    // The last bytes are padding and the name of the last page.
    if (maps) {
      EXPECT_EQ(maps.value().defect, some_maps().defect) << length;
      EXPECT_GT(length, whole.size() - 32) << length;
      continue;
    }
    EXPECT_EQ(maps.error().message.rfind("maps.tif: ", 0), 0U) << maps.error().message;
  }
  write(whole.substr(0, whole.size() / 2));
  expect_refusal("sensor maps are written by lsv calibrate camera", maps_path());
}

TEST_F(SensorMapsFile, NumbersThatAreNoneAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf, 1e9F}) {
    SensorMaps maps = some_maps();
    maps.offset_counts[13 * 2 + 4] = bad;
    write(sensor_maps_tiff(maps).value());
    expect_refusal("offset_counts must hold counts but does not at column 4, row 2", maps_path());
  }
  for (const float bad : {nan, inf, 0.0F, -1.0F}) {
    SensorMaps maps = some_maps();
    maps.gain_ratio[90] = bad;
    write(sensor_maps_tiff(maps).value());
    expect_refusal("gain_ratio must hold gains of 0.01 to 100 but does not at column 12, row 6",
                   maps_path());
  }
  SensorMaps maps = some_maps();
  maps.defect[0] = 2;
  write(sensor_maps_tiff(maps).value());
  expect_refusal("defect must hold 0 or 1 but does not at column 0, row 0", maps_path());
}

TEST(SensorMapsTiff, RefusesMapsWithHoles) {
  SensorMaps maps = some_maps();
  maps.gain_ratio.pop_back();
  EXPECT_FALSE(sensor_maps_tiff(maps));
  EXPECT_FALSE(sensor_maps_tiff({}));
}

TEST(ParseSensorMaps, RefusesOtherFiles) {
  for (const std::string& bytes :
       {std::string(), std::string("P5\n1 1\n255\nx"), std::string("II*\0\x08\0\0\0", 8)}) {
    const Result<SensorMaps> maps = parse_sensor_maps(bytes, "x.tif");
    ASSERT_FALSE(maps);
    EXPECT_EQ(maps.error().message.rfind("x.tif: ", 0), 0U) << maps.error().message;
  }
}

TEST(CheckFormat, NamesBinningAndTheRest) {
  Calibration calibration;
  const FrameFormat frames{.width_px = 64, .height_px = 48};
  EXPECT_TRUE(check_format(calibration, "c.toml", frames));
  const auto says = [&](int width_px, int height_px, int bit_depth) {
    calibration.format =
        SensorFormat{.width_px = width_px, .height_px = height_px, .bit_depth = bit_depth};
    const Result<void> checked = check_format(calibration, "c.toml", frames);
    return checked ? std::string("ok") : checked.error().message;
  };
  EXPECT_EQ(says(64, 48, 8), "ok");
  EXPECT_NE(says(128, 96, 8).find("looks binned by 2: the pixel pitch would then be 2 times"),
            std::string::npos);
  EXPECT_NE(says(192, 144, 8).find("binned by 3"), std::string::npos);
  EXPECT_EQ(says(128, 48, 8).find("binned"), std::string::npos);
  EXPECT_EQ(says(128, 97, 8).find("binned"), std::string::npos);
  EXPECT_EQ(says(64, 48, 12).rfind("c.toml: is for frames of 64 x 48 px with 12 bit", 0), 0U)
      << says(64, 48, 12);
  EXPECT_NE(says(32, 24, 8).find("these are 64 x 48 px with 8 bit"), std::string::npos);
}

}  // namespace
}  // namespace lsv
