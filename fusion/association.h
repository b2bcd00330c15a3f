// SPDX-License-Identifier: BSD-3-Clause
// Which pose of an estimate belongs to which pose of the truth.
// By time: two poses belong together when each is the nearest to the other and their stamps differ
// by at most `max_dt_s`. Of two that are equally near (to 1 us) an estimate takes the earlier truth
// and a truth the later estimate, so that stamps half a period apart all find a partner. No pose is
// used twice and both sequences of stamps increase. Nothing is interpolated. By index where a
// trajectory has no time: both must be of one length. Pure functions.
#pragma once

#include <cstddef>
#include <vector>

#include "lsv/core/result.h"
#include "lsv/core/trajectory.h"

namespace lsv {

struct AssociationOptions {
  double max_dt_s = 0.01;  // 0 to 1e6
  double offset_s = 0.0;   // added to the stamps of the estimate; within 4e9
};

/// Poses of one index belong together. Where one trajectory is planar, both are: z is 0 and of the
/// rotation the heading is left. Where one has no rotation, neither has.
struct PosePairs {
  std::vector<TrajectoryPose> estimate;  // stamps with the offset
  std::vector<TrajectoryPose> truth;
  std::vector<PlanarCovariance> covariances;  // of the estimate; one for each pair, or none at all
  bool has_time = false;
  bool has_rotation = false;
  bool is_planar = false;
  double mean_dt_s = kUnknown;  // of the amounts by which stamps differ
  double max_dt_s = kUnknown;

  std::size_t size() const { return estimate.size(); }
};

/// At least one pair. bad_input when stamps do not increase, time ranges do not overlap, fewer than
/// a tenth of the poses that could have a partner have one, or lengths without time differ;
/// invalid_argument for options out of range.
Result<PosePairs> associate(const Trajectory& estimate, const Trajectory& truth,
                            const AssociationOptions& options);

}  // namespace lsv
