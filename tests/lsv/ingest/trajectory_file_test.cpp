// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/trajectory_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace lsv {
namespace {

TrajectoryFile parsed(const std::string& text, TrajectoryFormat format) {
  Result<TrajectoryFile> out = parse_trajectory(text, "t", format);
  EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
  return out.ok() ? std::move(out).value() : TrajectoryFile{};
}

// A quarter turn to the left; the nanoseconds of an epoch stamp do not fit in a double.
TEST(TrajectoryFile, ReadsTum) {
  const TrajectoryFile file = parsed(
      "# t x y z qx qy qz qw\n\n1700000000.000000001 1 -2 3 0 0 0.70710678 0.70710678\r\n"
      " 1700000000.000000002\t1e0 -2 3 0 0 0 -1",
      TrajectoryFormat::tum);
  ASSERT_EQ(file.trajectory.poses.size(), 2U);
  const TrajectoryPose& first = file.trajectory.poses[0];
  EXPECT_EQ(first.stamp.ns, 1'700'000'000'000'000'001);
  EXPECT_EQ(first.x_m, 1.0);
  EXPECT_EQ(first.y_m, -2.0);
  EXPECT_EQ(first.z_m, 3.0);
  EXPECT_DOUBLE_EQ(first.rotation.z, std::sqrt(0.5));  // to length 1
  EXPECT_EQ(file.trajectory.poses[1].rotation.w, -1.0);
  EXPECT_TRUE(file.trajectory.has_time);
  EXPECT_TRUE(file.trajectory.has_rotation);
  EXPECT_FALSE(file.trajectory.is_planar);
}

TEST(TrajectoryFile, AByteOrderMarkDoesNotCount) {
  EXPECT_EQ(parsed("\xEF\xBB\xBF"
                   "1 0 0 0 0 0 0 1\n",
                   TrajectoryFormat::tum)
                .trajectory.poses.size(),
            1U);
  EXPECT_EQ(
      parsed("\xEF\xBB\xBFtime_s,x_m,y_m\n1,0,0\n", TrajectoryFormat::csv).trajectory.poses.size(),
      1U);
}

// Rows of the matrix are rows: transposed, the turn goes to the other side.
TEST(TrajectoryFile, ReadsKitti) {
  const TrajectoryFile file =
      parsed("1 0 0 0 0 1 0 0 0 0 1 0\n0 -1 0 5 1 0 0 6 0 0 1 7\n-1 0 0 0 0 1 0 0 0 0 -1 0\n",
             TrajectoryFormat::kitti);
  ASSERT_EQ(file.trajectory.poses.size(), 3U);
  const TrajectoryPose& turned = file.trajectory.poses[1];
  EXPECT_EQ(turned.stamp.ns, 1);
  EXPECT_EQ(turned.x_m, 5.0);
  EXPECT_EQ(turned.y_m, 6.0);
  EXPECT_EQ(turned.z_m, 7.0);
  EXPECT_NEAR(turned.rotation.z, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(turned.rotation.w, std::sqrt(0.5), 1e-15);
  EXPECT_EQ(std::abs(file.trajectory.poses[2].rotation.y), 1.0);
  EXPECT_FALSE(file.trajectory.has_time);
}

// Every rotation that has a matrix comes back, whichever of its numbers is the largest.
TEST(TrajectoryFile, KittiMatricesAreTheirQuaternions) {
  for (int i = 0; i < 81; ++i) {
    double q[4] = {i % 3 - 1.0, i / 3 % 3 - 0.9, i / 9 % 3 - 1.1, i / 27 % 3 - 0.95};
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& part : q) part /= length;
    const auto [x, y, z, w] = q;
    char line[400];
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g 0 %.17g %.17g %.17g 0 %.17g %.17g %.17g 0",
                  1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                  2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                  2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y));
    const Quaternion found = parsed(line, TrajectoryFormat::kitti).trajectory.poses.at(0).rotation;
    const double same = found.x * x + found.y * y + found.z * z + found.w * w;
    EXPECT_NEAR(std::abs(same), 1.0, 1e-14) << line;
  }
}

TEST(TrajectoryFile, ReadsCsvByName) {
  const TrajectoryFile file = parsed(
      "# unit: m\nyaw_rad,time_s,y_m,x_m,cov_yy_m2,cov_xx_m2,cov_xy_m2,status\n"
      "0.5,0.1,2,1,4,3,-1,ok\n,0.2,,,,,,lost\n7,0.3,2,1,,,,ok\n",
      TrajectoryFormat::csv);
  const Trajectory& t = file.trajectory;
  ASSERT_EQ(t.poses.size(), 2U);
  EXPECT_EQ(file.rows_skipped, 1U);
  EXPECT_EQ(file.first_skipped_line, 4U);
  EXPECT_EQ(t.poses[1].stamp.ns, 300'000'000);
  EXPECT_EQ(t.poses[0].x_m, 1.0);
  EXPECT_DOUBLE_EQ(2.0 * std::asin(t.poses[0].rotation.z), 0.5);
  EXPECT_TRUE(t.is_planar);
  ASSERT_EQ(t.covariances.size(), 2U);
  EXPECT_EQ(t.covariances[0].xx_m2, 3.0);
  EXPECT_EQ(t.covariances[0].xy_m2, -1.0);
  EXPECT_EQ(t.covariances[0].yy_m2, 4.0);
  EXPECT_TRUE(std::isnan(t.covariances[0].yawyaw_rad2));
  EXPECT_TRUE(std::isnan(t.covariances[1].xx_m2));
}

TEST(TrajectoryFile, ATrackWithoutYawHasNoRotation) {
  const TrajectoryFile file =
      parsed("time_s,x_m,y_m,status\n0,0,0,ok\n1,1,0,ok\n", TrajectoryFormat::csv);
  EXPECT_FALSE(file.trajectory.has_rotation);
  EXPECT_TRUE(std::isnan(file.trajectory.poses[0].rotation.w));
  EXPECT_TRUE(file.trajectory.covariances.empty());
}

TEST(TrajectoryFile, FormatByNameOrContent) {
  EXPECT_EQ(trajectory_format("a.csv", "").value(), TrajectoryFormat::csv);
  EXPECT_EQ(trajectory_format("a.tum", "").value(), TrajectoryFormat::tum);
  EXPECT_EQ(trajectory_format("a.kitti", "").value(), TrajectoryFormat::kitti);
  EXPECT_EQ(trajectory_format("a.txt", "# c\n1 2 3 4 5 6 7 8\n").value(), TrajectoryFormat::tum);
  EXPECT_EQ(trajectory_format("a.txt", "1 2 3 4 5 6 7 8 9 10 11 12").value(),
            TrajectoryFormat::kitti);
  EXPECT_NE(trajectory_format("a.txt", "\n1 2 3\n").error().message.find("a.txt:2: must hold 8"),
            std::string::npos);
  EXPECT_NE(trajectory_format("a.txt", "1 2 3 4 5 6 7 8 9 10 11 12 13").error().message.find(":1:"),
            std::string::npos);
  EXPECT_NE(trajectory_format("a.txt", "#\n").error().message.find("no pose"), std::string::npos);
  EXPECT_NE(trajectory_format("a.bag", "").error().message.find("a.bag: the extension"),
            std::string::npos);
}

TEST(TrajectoryFile, HostileTextIsRefusedWithFileLineAndField) {
  using enum TrajectoryFormat;
  std::string a_lot(1000, 'a');
  a_lot.append(" 0 0 0 0 0 0 1");
  const std::string header = "time_s,x_m,y_m,yaw_rad\n";
  const std::string cov = "time_s,x_m,y_m,cov_xx_m2,cov_xy_m2,cov_yy_m2\n";
  const struct {
    TrajectoryFormat format;
    std::string text;
    std::string says;
  } cases[] = {
      {tum, "", "t: holds no pose"},
      {tum, "# only\n", "t: holds no pose"},
      {tum, "0 0 0 0 0 0 0\n", "t:1: must hold t x y z"},
      {tum, "0 0 0 0 0 0 0 1 0\n", "t:1: must hold t x y z"},
      {tum, "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 x\n", "t:2: qw is \"x\", not a number"},
      {tum, "0 0 0 inf 0 0 0 1\n", "t:1: z is \"inf\""},
      {tum, "0 0 1e400 0 0 0 0 1\n", "t:1: y is \"1e400\""},
      {tum, "0 0 0 0 0 0 0 0\n", "t:1: qx qy qz qw: the quaternion"},
      {tum, "0 0 0 0 0 0 0 1.01\n", "the quaternion is not of length 1"},
      {tum, "1 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n", "t:2: t: the time does not increase"},
      {tum, "0 0 0 0 0 0 0 1\n0.0000000004 0 0 0 0 0 0 1\n", "does not increase"},
      {tum, "4.5e9 0 0 0 0 0 0 1\n", "beyond 126 years"},
      {tum, "1e30 0 0 0 0 0 0 1\n", "not a time in seconds"},
      {tum, "0 1e9 0 0 0 0 0 1\n", "t:1: the position is beyond 1e8 m"},
      {tum, a_lot + "\n", "aaa...\""},
      {kitti, "1 0 0 0 0 1 0 0 0 0 1\n", "t:1: must hold the 12 numbers"},
      {kitti, "1 0 0 0 0 1 0 nan 0 0 1 0\n", "t:1: ty is \"nan\""},
      {kitti, "1 0 0 0 0 1 0 0 0 0 -1 0\n", "t:1: r11 to r33 are not a rotation"},
      {kitti, "2 0 0 0 0 1 0 0 0 0 0.5 0\n", "not a rotation"},
      {kitti, "1 0 0 0 0 1 0 0 0 0 1 -1e9\n", "beyond 1e8 m"},
      {csv, "", "t: no line that names the columns"},
      {csv, header, "t: holds no pose"},
      {csv, header + "0,,0,0\n", "t: holds no pose: x_m, y_m or yaw_rad is empty"},
      {csv, header + "0,0,0,0\n1,0,0\n", "t:3: 3 cells under 4 columns"},
      {csv, header + ",0,0,0\n", "t:2: time_s is \"\""},
      {csv, header + "1,0,0,0\n1,,,\n", "t:3: time_s: the time does not increase"},
      {csv, header + "1,0,0,north\n", "t:2: yaw_rad is \"north\""},
      {csv, "time_s,x_m\n", "t: no column y_m"},
      {csv, "time_s,x_m,y_m,cov_xx_m2\n", "no column cov_xy_m2"},
      {csv, "time_s,x_m,y_m,cov_xyaw_m_rad,cov_yyaw_m_rad,cov_yawyaw_rad2\n",
       "no column cov_xx_m2"},
      {csv, cov + "0,0,0,1,0,-1\n", "t:2: cov_yy_m2 is below 0"},
  };
  for (const auto& [format, text, says] : cases) {
    SCOPED_TRACE(says);
    const Result<TrajectoryFile> file = parse_trajectory(text, "t", format);
    ASSERT_FALSE(file.ok());
    EXPECT_EQ(file.error().code, ErrorCode::bad_input);
    EXPECT_NE(file.error().message.find(says), std::string::npos) << file.error().message;
    EXPECT_EQ(file.error().message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace lsv
