// SPDX-License-Identifier: BSD-3-Clause
#include "sim/motion_profile.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace lsv::sim {
namespace {

std::string write_table(const std::string& text) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const auto directory = std::filesystem::path(testing::TempDir()) /
                         (std::string(test->name()) + "_" + std::to_string(::getpid()));
  std::filesystem::create_directories(directory);
  const auto path = directory / "motion.csv";
  std::ofstream(path) << text;
  return path.string();
}

TEST(MotionProfile, ParkedStaysAndConstantVelocityGoesOn) {
  EXPECT_EQ(parked()(1000).x_px, 0.0);
  const PatternMotion motion = constant_velocity(0.5, -2.0)(10);
  EXPECT_DOUBLE_EQ(motion.x_px, 5.0);
  EXPECT_DOUBLE_EQ(motion.y_px, -20.0);
  EXPECT_DOUBLE_EQ(motion.vx_px_per_frame, 0.5);
  EXPECT_DOUBLE_EQ(motion.vy_px_per_frame, -2.0);
}

/// Velocity is the slope of position: central differences agree to the third order of the ramps.
void expect_velocity_is_slope(const MotionProfile& profile, std::int64_t frames,
                              double tolerance_px) {
  for (std::int64_t k = 1; k + 1 < frames; ++k) {
    const PatternMotion now = profile(k);
    EXPECT_NEAR((profile(k + 1).x_px - profile(k - 1).x_px) / 2.0, now.vx_px_per_frame,
                tolerance_px)
        << "frame " << k;
    EXPECT_NEAR((profile(k + 1).y_px - profile(k - 1).y_px) / 2.0, now.vy_px_per_frame,
                tolerance_px)
        << "frame " << k;
  }
}

TEST(MotionProfile, TheDriveSpeedsUpStopsReversesAndRests) {
  constexpr std::int64_t kFrames = 400;
  const MotionProfile profile = drive(6.0, 1.5, kFrames);
  expect_velocity_is_slope(profile, kFrames, 0.01);
  double fastest = 0.0;
  double slowest = 0.0;
  int at_rest = 0;
  for (std::int64_t k = 1; k < kFrames; ++k) {
    const double dx_px = profile(k).x_px - profile(k - 1).x_px;
    fastest = std::max(fastest, dx_px);
    slowest = std::min(slowest, dx_px);
    if (k > kFrames / 4 && k < 3 * kFrames / 4) at_rest += dx_px == 0.0;
  }
  EXPECT_NEAR(fastest, 6.0, 1e-9);
  EXPECT_NEAR(slowest, -4.8, 1e-9);
  EXPECT_GE(at_rest, kFrames / 10 - 1);
  EXPECT_EQ(profile(0).x_px, 0.0);
  EXPECT_NEAR(profile(kFrames).vx_px_per_frame, 0.0, 1e-12);
}

TEST(MotionProfile, APiecewiseRampHasTheTravelOfItsMeanVelocity) {
  const MotionProfile profile = piecewise({{10.0, 4.0, 0.0}, {5.0, 4.0, 2.0}});
  EXPECT_DOUBLE_EQ(profile(10).x_px, 20.0);
  EXPECT_DOUBLE_EQ(profile(15).x_px, 40.0);
  EXPECT_DOUBLE_EQ(profile(15).y_px, 5.0);
  EXPECT_DOUBLE_EQ(profile(20).x_px, 60.0);
  EXPECT_DOUBLE_EQ(profile(20).y_px, 15.0);
  EXPECT_EQ(piecewise({})(7).x_px, 0.0);
}

TEST(MotionProfile, TheSinusoidNeverExceedsItsSpeed) {
  const MotionProfile profile = sinusoid(2.0, -1.0, 60.0);
  expect_velocity_is_slope(profile, 200, 0.01);
  for (std::int64_t k = 1; k < 200; ++k)
    EXPECT_LE(std::abs(profile(k).x_px - profile(k - 1).x_px), 2.0);
  EXPECT_NEAR(profile(60).x_px, 0.0, 1e-9);
  EXPECT_GT(profile(15).x_px, 19.0);
  EXPECT_LT(profile(15).y_px, -9.0);
}

TEST(MotionProfile, RandomShiftsFillTheirRangeAndRepeat) {
  const MotionProfile profile = random_shifts(3.0, 0.5, 2000, 8);
  const MotionProfile same = random_shifts(3.0, 0.5, 2000, 8);
  const MotionProfile other = random_shifts(3.0, 0.5, 2000, 9);
  expect_velocity_is_slope(profile, 2000, 1e-9);
  double lowest = 0.0;
  double highest = 0.0;
  for (std::int64_t k = 1; k < 2000; ++k) {
    const double dx_px = profile(k).x_px - profile(k - 1).x_px;
    lowest = std::min(lowest, dx_px);
    highest = std::max(highest, dx_px);
    EXPECT_LE(std::abs(profile(k).y_px - profile(k - 1).y_px), 0.5 + 1e-12);
  }
  EXPECT_GT(highest, 2.9);
  EXPECT_LE(highest, 3.0 + 1e-12);
  EXPECT_LT(lowest, -2.9);
  EXPECT_EQ(profile(1999).x_px, same(1999).x_px);
  EXPECT_NE(profile(1999).x_px, other(1999).x_px);
  EXPECT_EQ(profile(5000).x_px, profile(1999).x_px);
}

TEST(MotionTable, ReadsColumnsByName) {
  const auto table = read_motion_table(
      write_table("# made by hand\r\nframe,y_px,x_px\r\n0,1.5,10\r\n1,2.5,13\r\n2,2.5,14\r\n"));
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_EQ(table.value().frames, 3);
  const PatternMotion motion = table.value().profile(1);
  EXPECT_DOUBLE_EQ(motion.x_px, 13.0);
  EXPECT_DOUBLE_EQ(motion.y_px, 2.5);
  EXPECT_DOUBLE_EQ(motion.vx_px_per_frame, 2.0);
  EXPECT_DOUBLE_EQ(motion.vy_px_per_frame, 0.5);
  EXPECT_DOUBLE_EQ(table.value().profile(0).vx_px_per_frame, 3.0);
}

TEST(MotionTable, RefusesWhatIsNoTableAndNamesTheFile) {
  for (const char* text : {"", "# only a comment\n", "frame,x_px\n0,1\n", "x_px,y_px\n",
                           "x_px,y_px\n1\n", "x_px,y_px\n1,two\n", "x_px,y_px\n1,nan\n",
                           "x_px,y_px\n1,\n", "x_px,y_px\n1,2,3\n", "x_px,y_px\n1,1e999\n"}) {
    const std::string path = write_table(text);
    const auto table = read_motion_table(path);
    ASSERT_FALSE(table.ok()) << text;
    EXPECT_EQ(table.error().code, ErrorCode::bad_input);
    EXPECT_NE(table.error().message.find(path), std::string::npos);
  }
  EXPECT_FALSE(read_motion_table("no/such/file.csv").ok());
}

}  // namespace
}  // namespace lsv::sim
