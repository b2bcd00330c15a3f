// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/evaluation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lsv {
namespace {

constexpr std::size_t kDriftLengths = 8;  // as the KITTI benchmark: 100 to 800 m of about 1 km
constexpr double kUsualGaps = 10.0;

Result<void> check(const EvaluationOptions& options) {
  const auto is_length = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!is_length(options.rpe_m) || !is_length(options.rpe_s) ||
      !std::ranges::all_of(options.segments_m, is_length))
    return Error{ErrorCode::invalid_argument, "lengths of segments must be above 0"};
  return {};
}

PosePairs with_aligned_estimate(PosePairs pairs, const Alignment& alignment) {
  for (TrajectoryPose& pose : pairs.estimate) pose = aligned(alignment, pose);
  return pairs;
}

/// Of the rotation: nothing where it is unknown.
ErrorStatistics angle_statistics(const PosePairs& pairs, const std::vector<double>& angles_rad) {
  return pairs.has_rotation ? statistics_of(angles_rad) : ErrorStatistics{};
}

SegmentSummary summary_of(const PosePairs& pairs, const std::vector<double>& progress,
                          double length) {
  SegmentSummary out{.length = length, .translation_m = {}, .rotation_rad = {}};
  std::vector<double> translation_m, rotation_rad, rate;
  for (const SegmentError& segment : segment_errors(pairs, progress, length)) {
    translation_m.push_back(segment.translation_m);
    rotation_rad.push_back(segment.rotation_rad);
    rate.push_back(segment.translation_m / segment.length);
  }
  out.translation_m = statistics_of(translation_m);
  out.rotation_rad = angle_statistics(pairs, rotation_rad);
  out.mean_rate = statistics_of(rate).mean;
  return out;
}

void add_drift(std::vector<double> lengths_m, TrajectoryEvaluation& to) {
  const double way_m = to.way_m.back();
  if (lengths_m.empty() && way_m > 0.0) {
    for (std::size_t i = 1; i <= kDriftLengths; ++i)
      lengths_m.push_back(0.1 * static_cast<double>(i) * way_m);
  }
  std::ranges::sort(lengths_m);
  double sum = 0.0;
  double count = 0.0;
  for (const double length_m : lengths_m) {
    const SegmentSummary summary = summary_of(to.pairs, to.way_m, length_m);
    if (summary.translation_m.count == 0) continue;
    const auto n = static_cast<double>(summary.translation_m.count);
    sum += n * summary.mean_rate;
    count += n;
    to.drift.push_back(summary);
  }
  if (count > 0.0) to.drift_percent = 100.0 * sum / count;
}

double covered_share(const PosePairs& pairs, const Trajectory& truth) {
  if (!pairs.has_time || !truth.has_time) return kUnknown;
  std::vector<double> gaps_s;
  for (std::size_t i = 1; i < pairs.size(); ++i)
    gaps_s.push_back(seconds_between(pairs.truth[i - 1].stamp, pairs.truth[i].stamp));
  std::ranges::sort(gaps_s);
  const double longest_s = kUsualGaps * gaps_s[gaps_s.size() / 2];
  const Stamp begin = truth.poses.front().stamp, end = truth.poses.back().stamp;
  double open_s = seconds_between(begin, pairs.truth.front().stamp) +
                  seconds_between(pairs.truth.back().stamp, end);
  for (const double gap_s : gaps_s) open_s += gap_s > longest_s ? gap_s : 0.0;
  return 1.0 - open_s / seconds_between(begin, end);
}

}  // namespace

Result<TrajectoryEvaluation> evaluate(const Trajectory& estimate, const Trajectory& truth,
                                      const EvaluationOptions& options) {
  if (Result<void> sound = check(options); !sound) return sound.error();
  Result<PosePairs> found = associate(estimate, truth, options.association);
  if (!found) return found.error();
  const PosePairs& pairs = found.value();
  if (pairs.size() < 2) {
    return Error{ErrorCode::bad_input,
                 "there is one pair of poses only, which tells of no way; two are the least"};
  }

  TrajectoryEvaluation out;
  for (std::size_t i = 0; i < kAllAlignmentKinds.size(); ++i) {
    const Alignment alignment = align(pairs, kAllAlignmentKinds[i]);
    PosePairs candidate = with_aligned_estimate(pairs, alignment);
    AbsoluteErrors errors = absolute_errors(candidate);
    const ErrorStatistics position_m = statistics_of(errors.position_m);
    out.ate_rmse_by_alignment_m[i] = position_m.rmse;
    if (kAllAlignmentKinds[i] != options.align) continue;
    out.alignment = alignment;
    out.pairs = std::move(candidate);
    out.errors = std::move(errors);
    out.position_m = position_m;
  }
  out.position_nees = position_nees(pairs, out.alignment);
  if (pairs.has_rotation) out.pose_nees = pose_nees(pairs, out.alignment);
  out.rotation_rad = angle_statistics(out.pairs, out.errors.rotation_rad);
  out.heading_rad = angle_statistics(out.pairs, out.errors.heading_rad);
  out.way_m = path_m(out.pairs);
  out.time_s = elapsed_s(out.pairs);
  out.rpe_m = summary_of(out.pairs, out.way_m, options.rpe_m);
  out.rpe_s = summary_of(out.pairs, out.time_s, options.rpe_s);
  add_drift(options.segments_m, out);
  out.covered_share = covered_share(pairs, truth);
  out.end_error_m = out.errors.position_m.back();
  return out;
}

}  // namespace lsv
