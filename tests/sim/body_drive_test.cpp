// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "sim/drive_sensors.h"

namespace lsv::sim {
namespace {

TEST(BodyDrive, StraightGoesForward) {
  const BodyDrive drive = straight(10.0, 0.2);
  const BodyPose end = drive.pose(drive.duration_s());
  EXPECT_NEAR(drive.duration_s(), 10.0, 1e-12);
  EXPECT_NEAR(end.x_m, 0.2 * 9.0, 1e-12);  // half of each second of speeding up and braking
  EXPECT_EQ(end.y_m, 0.0);
  EXPECT_NEAR(drive.way(5.0).way_m, 0.2 * 4.5, 1e-12);
  EXPECT_EQ(drive.pose(-1.0).x_m, 0.0);
  EXPECT_EQ(drive.pose(99.0).x_m, end.x_m);
}

// To the left: counter-clockwise about a centre at +y.
TEST(BodyDrive, CircleIsACircleToTheLeft) {
  const BodyDrive drive = circle(20.0, 0.1, 0.4);
  for (const double time_s : {1.0, 7.3, 20.0}) {
    const BodyPose pose = drive.pose(time_s);
    EXPECT_NEAR(std::hypot(pose.x_m, pose.y_m - 0.4), 0.4, 1e-6) << time_s;
    EXPECT_NEAR(pose.yaw_rad, 0.25 * time_s, 1e-6);
  }
  EXPECT_GT(drive.pose(2.0).y_m, 0.0);
}

// The place is the integral of way and heading: summed in small steps, across the segments.
TEST(BodyDrive, PlaceFollowsWayAndHeading) {
  for (const BodyDrive& drive : {figure_drive(30.0, 0.15, 0.6), slalom(30.0, 0.1, 0.5, 6.0)}) {
    double x_m = 0.0;
    double y_m = 0.0;
    constexpr int kSteps = 30000;
    for (int i = 0; i < kSteps; ++i) {
      const BodyWay from = drive.way(30.0 * i / kSteps);
      const BodyWay to = drive.way(30.0 * (i + 1) / kSteps);
      const double yaw_rad = 0.5 * (from.yaw_rad + to.yaw_rad);
      x_m += (to.way_m - from.way_m) * std::cos(yaw_rad);
      y_m += (to.way_m - from.way_m) * std::sin(yaw_rad);
    }
    EXPECT_NEAR(drive.pose(30.0).x_m, x_m, 1e-7);
    EXPECT_NEAR(drive.pose(30.0).y_m, y_m, 1e-7);
  }
}

/// Sum of what a sensor reads over a quarter of a circle to the left, radius 1 m.
struct Sum {
  double x_m = 0.0;
  double y_m = 0.0;
};
Sum quarter_turn(const SensorPlace& place) {
  const double end_s = 0.5 * std::numbers::pi / 0.1;
  Sum out;
  for (const TrackReading& r :
       read_track(circle(end_s, 0.1, 1.0), place, {.rate_hz = 100.0, .end_s = end_s})) {
    out.x_m += r.dx_m;
    out.y_m += r.dy_m;
  }
  return out;
}

// In a left turn the left side has the shorter way and the nose swings to the left.
TEST(DriveSensors, SignsInALeftTurn) {
  constexpr double kQuarter_rad = 0.5 * std::numbers::pi;
  constexpr double kCoarse_m = 2e-3;  // the last interval of 10 ms may be missing
  EXPECT_NEAR(quarter_turn({}).x_m, kQuarter_rad, kCoarse_m);
  EXPECT_NEAR(quarter_turn({.y_m = 0.3}).x_m, 0.7 * kQuarter_rad, kCoarse_m);
  EXPECT_NEAR(quarter_turn({.y_m = -0.3}).x_m, 1.3 * kQuarter_rad, kCoarse_m);
  EXPECT_NEAR(quarter_turn({.x_m = 0.3}).y_m, 0.3 * kQuarter_rad, kCoarse_m);
  // A sensor that looks to the left sees forward travel as travel to its right.
  EXPECT_NEAR(quarter_turn({.yaw_rad = kQuarter_rad}).y_m, -kQuarter_rad, kCoarse_m);
  EXPECT_NEAR(quarter_turn({.reads_ratio = 1.1}).x_m, 1.1 * kQuarter_rad, kCoarse_m);
}

// The closed form of what a sensor travels, against the places of the sensor on the ground.
TEST(DriveSensors, ReadsTheMotionOfItsPlace) {
  const BodyDrive drive = figure_drive(30.0, 0.1, 0.5);
  const SensorPlace place{.x_m = 0.3, .y_m = -0.2, .yaw_rad = 0.7};
  const auto ground = [&](double time_s) {
    const BodyPose pose = drive.pose(time_s);
    return Sum{pose.x_m + std::cos(pose.yaw_rad) * place.x_m - std::sin(pose.yaw_rad) * place.y_m,
               pose.y_m + std::sin(pose.yaw_rad) * place.x_m + std::cos(pose.yaw_rad) * place.y_m};
  };
  for (const TrackReading& r : read_track(drive, place, {.rate_hz = 1000.0, .end_s = 30.0})) {
    const double from_s = 1e-9 * static_cast<double>(r.since_ns);
    const double to_s = 1e-9 * static_cast<double>(r.time_ns);
    const Sum from = ground(from_s);
    const Sum to = ground(to_s);
    const double heading_rad = drive.way(0.5 * (from_s + to_s)).yaw_rad + place.yaw_rad;
    const double dx_m = to.x_m - from.x_m;
    const double dy_m = to.y_m - from.y_m;
    ASSERT_NEAR(r.dx_m, std::cos(heading_rad) * dx_m + std::sin(heading_rad) * dy_m, 1e-10);
    ASSERT_NEAR(r.dy_m, -std::sin(heading_rad) * dx_m + std::cos(heading_rad) * dy_m, 1e-10);
  }
}

TEST(DriveSensors, RefusedFramesAreSpannedAndLostGroundIsNot) {
  const BodyDrive drive = straight(10.0, 0.1);
  const double way_m = drive.way(10.0).way_m;
  const auto travelled = [](const std::vector<TrackReading>& readings) {
    double out = 0.0;
    for (const TrackReading& r : readings) out += r.dx_m;
    return out;
  };
  const auto refused =
      read_track(drive, {}, {.rate_hz = 100.0, .end_s = 10.0, .refused_ratio = 0.2, .seed = 3});
  EXPECT_EQ(refused.size(), 1000U);
  EXPECT_NEAR(travelled(refused), way_m, 1e-3);
  const auto lost = read_track(drive, {}, {.rate_hz = 100.0, .end_s = 10.0, .lost = {{4.0, 5.0}}});
  EXPECT_NEAR(travelled(lost), way_m - 0.1, 2.5e-3);
  // After the loss the shift is from the frame before, which was refused.
  const TrackReading& first = lost[500];
  EXPECT_EQ(first.time_ns, 5'010'000'000);
  EXPECT_TRUE(first.accepted);
  EXPECT_EQ(first.since_ns, 5'000'000'000);
  EXPECT_FALSE(lost[499].accepted);
}

TEST(DriveSensors, NoiseIsAsAskedForAndSeeded) {
  const BodyDrive drive = straight(100.0, 0.1);
  const ReferenceConfig config{
      .rate_hz = 50.0, .end_s = 100.0, .sigma_m = 1e-3, .sigma_yaw_rad = 2e-3, .seed = 5};
  const auto readings = read_reference(drive, config);
  double squares_y = 0.0;
  double squares_yaw = 0.0;
  for (const ReferenceReading& r : readings) {
    squares_y += r.y_m * r.y_m;
    squares_yaw += r.yaw_rad * r.yaw_rad;
  }
  const auto count = static_cast<double>(readings.size());
  EXPECT_EQ(readings.size(), 5001U);
  EXPECT_NEAR(std::sqrt(squares_y / count), 1e-3, 5e-5);
  EXPECT_NEAR(std::sqrt(squares_yaw / count), 2e-3, 1e-4);
  EXPECT_EQ(read_reference(drive, config)[7].x_m, readings[7].x_m);
  ReferenceConfig other = config;
  other.seed = 6;
  EXPECT_NE(read_reference(drive, other)[7].x_m, readings[7].x_m);
}

}  // namespace
}  // namespace lsv::sim
