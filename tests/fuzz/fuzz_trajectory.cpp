// SPDX-License-Identifier: BSD-3-Clause
// The first byte chooses the format; the rest is the file.
#include <cmath>

#include "lsv/ingest/trajectory_file.h"
#include "tests/fuzz/frame_checks.h"

namespace {

void check(const lsv::Trajectory& trajectory) {
  using lsv::fuzz::require;
  require(!trajectory.poses.empty(), "a trajectory has a pose");
  require(
      trajectory.covariances.empty() || trajectory.covariances.size() == trajectory.poses.size(),
      "each pose has its covariance");
  const lsv::TrajectoryPose* before = nullptr;
  for (const lsv::TrajectoryPose& pose : trajectory.poses) {
    require(before == nullptr || before->stamp < pose.stamp, "stamps increase");
    before = &pose;
    require(std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.z_m),
            "positions are finite");
    const lsv::Quaternion& q = pose.rotation;
    const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    require(trajectory.has_rotation ? std::abs(length2 - 1.0) < 1e-9 : std::isnan(length2),
            "a rotation is of length 1 or unknown");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using lsv::fuzz::require;
  if (size == 0) return 0;
  constexpr lsv::TrajectoryFormat kFormats[] = {
      lsv::TrajectoryFormat::csv, lsv::TrajectoryFormat::tum, lsv::TrajectoryFormat::kitti};
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  static_cast<void>(lsv::trajectory_format("t.txt", text));
  const auto file = lsv::parse_trajectory(text, "t.txt", kFormats[data[0] % 3]);
  if (file)
    check(file.value().trajectory);
  else
    require(file.error().message.find("t.txt") != std::string::npos, "an error names the file");
  return 0;
}
