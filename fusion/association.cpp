// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/association.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace lsv {
namespace {

constexpr double kLargestMaxDt_s = 1e6;
constexpr double kLargestOffset_s = 4e9;
constexpr double kNs = 1e9;
/// Stamps of two clocks, each rounded to ns, are equally near within less than this.
constexpr std::int64_t kTie_ns = 1000;
/// Of the poses of the shorter side that could have a partner.
constexpr double kLeastPairShare = 0.1;

using Poses = std::vector<TrajectoryPose>;

Error refused(std::string sentence) { return {ErrorCode::bad_input, std::move(sentence)}; }

std::string seconds_text(std::int64_t ns) {
  char text[48];
  std::snprintf(text, sizeof text, "%.6g", static_cast<double>(ns) / kNs);
  return text;
}

std::string range_text(const Poses& poses) {
  return seconds_text(poses.front().stamp.ns) + " to " + seconds_text(poses.back().stamp.ns) + " s";
}

Result<void> check(const Poses& poses, bool has_time, const char* name) {
  if (poses.empty()) return refused(std::string("the ") + name + " holds no pose");
  if (!has_time) return {};
  const auto is_late = [](const TrajectoryPose& a, const TrajectoryPose& b) {
    return a.stamp >= b.stamp;
  };
  const auto late = std::ranges::adjacent_find(poses, is_late);
  if (late != poses.end()) {
    return refused(std::string("the stamps of the ") + name + " do not increase after " +
                   seconds_text(late->stamp.ns) + " s");
  }
  for (const TrajectoryPose& end : {poses.front(), poses.back()}) {
    if (std::abs(end.stamp.ns) > kFarthestStamp_ns)
      return refused(std::string("the stamps of the ") + name + " reach beyond 126 years");
  }
  return {};
}

/// Index of the pose nearest to `stamp`. Of two that are nearer to each other than `kTie_ns` the
/// earlier counts, or the later: an estimate takes the earlier truth and a truth the later
/// estimate, so that stamps half a period apart are pairs and not chains.
enum class Tie { earlier, later };
std::size_t nearest(const Poses& poses, Stamp stamp, Tie tie) {
  const auto after = std::ranges::lower_bound(poses, stamp, {}, &TrajectoryPose::stamp);
  if (after == poses.begin()) return 0;
  const auto before = after - 1;
  if (after == poses.end()) return static_cast<std::size_t>(before - poses.begin());
  const std::int64_t nearer_ns = (stamp.ns - before->stamp.ns) - (after->stamp.ns - stamp.ns);
  const bool is_after = tie == Tie::earlier ? nearer_ns > kTie_ns : nearer_ns >= -kTie_ns;
  return static_cast<std::size_t>((is_after ? after : before) - poses.begin());
}

/// Poses that lie within the time of the others, `room_ns` around it.
std::size_t count_within(const Poses& poses, const Poses& others, std::int64_t room_ns) {
  const std::int64_t from_ns = others.front().stamp.ns - room_ns;
  const std::int64_t to_ns = others.back().stamp.ns + room_ns;
  return static_cast<std::size_t>(std::ranges::count_if(poses, [&](const TrajectoryPose& pose) {
    return pose.stamp.ns >= from_ns && pose.stamp.ns <= to_ns;
  }));
}

Poses moved_in_time(const Poses& poses, std::int64_t offset_ns) {
  Poses out = poses;
  for (TrajectoryPose& pose : out) pose.stamp.ns += offset_ns;
  return out;
}

void add_pair(const Trajectory& estimate, const TrajectoryPose& moved, std::size_t i,
              const TrajectoryPose& truth, PosePairs& to) {
  to.estimate.push_back(moved);
  to.truth.push_back(truth);
  if (!estimate.covariances.empty()) to.covariances.push_back(estimate.covariances[i]);
}

Result<PosePairs> by_index(const Trajectory& estimate, const Trajectory& truth) {
  if (estimate.poses.size() != truth.poses.size()) {
    return refused("without time in both, poses belong together by their order, but there are " +
                   std::to_string(estimate.poses.size()) + " of the estimate and " +
                   std::to_string(truth.poses.size()) + " of the truth");
  }
  PosePairs out;
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    add_pair(estimate, estimate.poses[i], i, truth.poses[i], out);
    if (estimate.has_time) out.truth.back().stamp = out.estimate.back().stamp;
  }
  out.has_time = estimate.has_time || truth.has_time;
  return out;
}

Result<PosePairs> by_time(const Trajectory& estimate, const Trajectory& truth,
                          const AssociationOptions& options) {
  const Poses moved = moved_in_time(estimate.poses, std::llround(options.offset_s * kNs));
  if (Result<void> sound = check(moved, true, "estimate, with the offset,"); !sound)
    return sound.error();
  if (moved.back().stamp < truth.poses.front().stamp ||
      truth.poses.back().stamp < moved.front().stamp) {
    return refused("the times do not overlap: the estimate is from " + range_text(moved) +
                   ", the truth from " + range_text(truth.poses) +
                   "; an offset (--offset-s) moves the estimate");
  }
  const std::int64_t max_dt_ns = std::llround(options.max_dt_s * kNs);
  PosePairs out;
  out.has_time = true;
  std::int64_t largest_ns = 0;
  std::int64_t least_ns = kFarthestStamp_ns;
  double sum_s = 0.0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const std::size_t j = nearest(truth.poses, moved[i].stamp, Tie::earlier);
    const std::int64_t dt_ns = std::abs(moved[i].stamp.ns - truth.poses[j].stamp.ns);
    least_ns = std::min(least_ns, dt_ns);
    if (dt_ns > max_dt_ns || nearest(moved, truth.poses[j].stamp, Tie::later) != i) continue;
    add_pair(estimate, moved[i], i, truth.poses[j], out);
    largest_ns = std::max(largest_ns, dt_ns);
    sum_s += static_cast<double>(dt_ns) / kNs;
  }
  if (out.size() == 0) {
    return refused("no stamps are within " + std::to_string(options.max_dt_s) +
                   " s of each other, the nearest differ by " + seconds_text(least_ns) +
                   " s; --max-dt-s allows more");
  }
  const std::size_t there = std::min(count_within(moved, truth.poses, max_dt_ns),
                                     count_within(truth.poses, moved, max_dt_ns));
  if (static_cast<double>(out.size()) < kLeastPairShare * static_cast<double>(there)) {
    return refused("only " + std::to_string(out.size()) + " of " + std::to_string(there) +
                   " poses have a partner within " + std::to_string(options.max_dt_s) +
                   " s, which tells little of the others; --max-dt-s allows more");
  }
  out.max_dt_s = static_cast<double>(largest_ns) / kNs;
  out.mean_dt_s = sum_s / static_cast<double>(out.size());
  return out;
}

void flatten(Poses& poses) {
  for (TrajectoryPose& pose : poses) {
    pose.z_m = 0.0;
    const double half_rad = 0.5 * heading_rad(pose.rotation);
    pose.rotation = {.x = 0.0, .y = 0.0, .z = std::sin(half_rad), .w = std::cos(half_rad)};
  }
}

}  // namespace

Result<PosePairs> associate(const Trajectory& estimate, const Trajectory& truth,
                            const AssociationOptions& options) {
  if (!(options.max_dt_s >= 0.0 && options.max_dt_s <= kLargestMaxDt_s))
    return Error{ErrorCode::invalid_argument, "max_dt_s must be from 0 to 1e6"};
  if (!(std::abs(options.offset_s) <= kLargestOffset_s))
    return Error{ErrorCode::invalid_argument, "offset_s must be within 4e9"};
  if (Result<void> sound = check(estimate.poses, estimate.has_time, "estimate"); !sound)
    return sound.error();
  if (Result<void> sound = check(truth.poses, truth.has_time, "truth"); !sound)
    return sound.error();
  Result<PosePairs> pairs = estimate.has_time && truth.has_time ? by_time(estimate, truth, options)
                                                                : by_index(estimate, truth);
  if (!pairs) return pairs;
  PosePairs& out = pairs.value();
  out.has_rotation = estimate.has_rotation && truth.has_rotation;
  out.is_planar = estimate.is_planar || truth.is_planar;
  if (out.is_planar && !estimate.is_planar) flatten(out.estimate);
  if (out.is_planar && !truth.is_planar) flatten(out.truth);
  if (!out.has_rotation) {
    for (Poses* poses : {&out.estimate, &out.truth}) {
      for (TrajectoryPose& pose : *poses) pose.rotation = {};
    }
  }
  return pairs;
}

}  // namespace lsv
