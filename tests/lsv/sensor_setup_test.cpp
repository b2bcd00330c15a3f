// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/sensor_setup.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "calibration/calibration_io.h"
#include "calibration/sensor_maps_io.h"
#include "calibration/sha256.h"
#include "lsv/odometer.h"
#include "tests/support/calibration.h"

namespace lsv {
namespace {

constexpr FrameFormat kFrames{.width_px = 96, .height_px = 80};

/// A calibration of the frames above and its maps, on disk.
class SensorSetup : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("lsv_setup_" + std::to_string(::getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    SensorMaps maps{.width_px = kFrames.width_px, .height_px = kFrames.height_px};
    for (int i = 0; i < kFrames.width_px * kFrames.height_px; ++i) {
      maps.offset_counts.push_back(static_cast<float>(i % 7));
      maps.gain_ratio.push_back(1.0F);
      maps.defect.push_back(0);
    }
    const std::string bytes = sensor_maps_tiff(maps).value();
    std::ofstream(folder_ / "maps.tif", std::ios::binary) << bytes;
    Calibration calibration = test::bridget_calibration();
    calibration.format = SensorFormat{.width_px = 96, .height_px = 80, .bit_depth = 8};
    calibration.maps = MapsRecord{.file = "maps.tif", .sha256 = sha256_hex(bytes)};
    std::ofstream(path()) << calibration_text(calibration);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path() const { return (folder_ / "calibration.toml").string(); }

  std::filesystem::path folder_;
};

TEST_F(SensorSetup, OneCallGivesCalibrationAndMaps) {
  TrackConfig config;
  const Result<void> set = set_calibration(config, path(), kFrames);
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(config.calibration.sc_x_ratio, 1.985);
  ASSERT_NE(config.sensor_maps, nullptr);
  EXPECT_EQ(config.sensor_maps->offset_counts[8], 1.0F);
  EXPECT_TRUE(Odometer::create(config, kFrames));
}

TEST_F(SensorSetup, ARegionCutsTheMaps) {
  TrackConfig config;
  const Roi roi{.x_px = 10, .y_px = 5, .width_px = 64, .height_px = 64};
  ASSERT_TRUE(set_calibration(config, path(), kFrames, roi));
  EXPECT_EQ(config.sensor_maps->width_px, 64);
  EXPECT_EQ(config.sensor_maps->offset_counts[0], static_cast<float>((5 * 96 + 10) % 7));
  FrameFormat cut = kFrames;
  cut.width_px = cut.height_px = 64;
  EXPECT_TRUE(Odometer::create(config, cut));
  EXPECT_FALSE(Odometer::create(config, kFrames));
  const Roi outside{.x_px = 40, .y_px = 5, .width_px = 64, .height_px = 64};
  EXPECT_FALSE(set_calibration(config, path(), kFrames, outside));
}

// What cannot be meant leaves the settings as they were.
TEST_F(SensorSetup, OtherFramesAreRefused) {
  TrackConfig config = test::bridget_config();
  config.calibration.sensor_name = "before";
  FrameFormat binned = kFrames;
  binned.width_px /= 2;
  binned.height_px /= 2;
  const Result<void> set = set_calibration(config, path(), binned);
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().message.rfind(path(), 0), 0U) << set.error().message;
  EXPECT_NE(set.error().message.find("looks binned by 2"), std::string::npos);
  FrameFormat deep = kFrames;
  deep.type = PixelType::mono16;
  deep.bit_depth = 12;
  EXPECT_FALSE(set_calibration(config, path(), deep));
  std::filesystem::remove(folder_ / "maps.tif");
  EXPECT_FALSE(set_calibration(config, path(), kFrames));
  EXPECT_EQ(config.calibration.sensor_name, "before");
  EXPECT_EQ(config.sensor_maps, nullptr);
}

// Maps that the calibration names must not be left out by forgetting them.
TEST_F(SensorSetup, MapsThatWereForgottenAreRefused) {
  TrackConfig config;
  config.calibration = load_calibration(path()).value();
  const Result<Odometer> odometer = Odometer::create(config, kFrames);
  ASSERT_FALSE(odometer);
  EXPECT_EQ(odometer.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(odometer.error().message.find("maps.tif"), std::string::npos);
  EXPECT_NE(odometer.error().message.find("set_calibration()"), std::string::npos);
  config.calibration.maps.reset();
  EXPECT_TRUE(Odometer::create(config, kFrames));
  FrameFormat large = kFrames;
  large.width_px = 97;
  EXPECT_FALSE(Odometer::create(config, large));
  FrameFormat deep = kFrames;
  deep.type = PixelType::mono16;
  deep.bit_depth = 12;
  EXPECT_FALSE(Odometer::create(config, deep));
}

}  // namespace
}  // namespace lsv
