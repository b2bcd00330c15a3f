// SPDX-License-Identifier: BSD-3-Clause
// How good an estimated trajectory is: association, alignment and all metrics in one call.
#pragma once

#include <array>
#include <vector>

#include "fusion/metrics.h"
#include "lsv/core/result.h"

namespace lsv {

struct EvaluationOptions {
  AssociationOptions association{};
  AlignmentKind align = AlignmentKind::none;
  double rpe_m = 1.0;  // length of the segments, > 0
  double rpe_s = 1.0;
  /// Of the drift, > 0 each. Empty: 10, 20, ... 80 % of the way.
  std::vector<double> segments_m{};
};

/// Errors over all segments of one length.
struct SegmentSummary {
  double length = kUnknown;  // asked for: m or s
  ErrorStatistics translation_m;
  ErrorStatistics rotation_rad;
  /// Translation over the length that the segment has, of m / m or m / s.
  double mean_rate = kUnknown;
};

struct TrajectoryEvaluation {
  PosePairs pairs;  // the estimate aligned
  Alignment alignment;
  /// In the order of kAllAlignmentKinds: what each would leave.
  std::array<double, kAllAlignmentKinds.size()> ate_rmse_by_alignment_m{};
  AbsoluteErrors errors;       // of each pair
  std::vector<double> way_m;   // along the truth, of each pair
  std::vector<double> time_s;  // since the first pair; empty without time
  ErrorStatistics position_m;
  ErrorStatistics rotation_rad;
  ErrorStatistics heading_rad;
  SegmentSummary rpe_m;
  SegmentSummary rpe_s;
  std::vector<SegmentSummary> drift;  // those with a segment, by rising length
  double drift_percent = kUnknown;    // 100 mean(translation error / length) over all of `drift`
  double end_error_m = kUnknown;      // position of the last pair
  /// Of the time of the truth, what the pairs cover: less what is before the first and after the
  /// last of them and gaps between two that are over ten times the usual one. NaN without time.
  double covered_share = kUnknown;
  NeesSummary position_nees;  // count 0 without covariance
  NeesSummary pose_nees;
};

/// bad_input for trajectories that cannot be associated or have one pair only, which tells of no
/// way; invalid_argument for options out of range.
Result<TrajectoryEvaluation> evaluate(const Trajectory& estimate, const Trajectory& truth,
                                      const EvaluationOptions& options);

}  // namespace lsv
