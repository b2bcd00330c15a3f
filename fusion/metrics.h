// SPDX-License-Identifier: BSD-3-Clause
// Errors of an estimated trajectory against the truth. Formulas: docs/evaluation.md. An error is
// estimate less truth. Pure functions of pairs whose estimate is aligned, unless stated.
#pragma once

#include <cstddef>
#include <vector>

#include "fusion/alignment.h"
#include "fusion/association.h"

namespace lsv {

/// Of `count` values; NaN without any. sd is about the mean with divisor count, so that
/// rmse^2 = mean^2 + sd^2.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = kUnknown;
  double mean = kUnknown;
  double median = kUnknown;
  double max = kUnknown;  // of the amounts
  double sd = kUnknown;
};
ErrorStatistics statistics_of(const std::vector<double>& values);

/// Of each pair. The angles are NaN without rotation.
struct AbsoluteErrors {
  std::vector<double> position_m;    // >= 0
  std::vector<double> rotation_rad;  // 0 to pi
  std::vector<double> heading_rad;   // (-pi, pi]
};
AbsoluteErrors absolute_errors(const PosePairs& pairs);

/// Way along the true positions up to each pair; the first is 0.
std::vector<double> path_m(const PosePairs& pairs);
/// Time since the first pair by the stamps of the truth; empty without time.
std::vector<double> elapsed_s(const PosePairs& pairs);

/// One segment: from a pair to a later one.
struct SegmentError {
  std::size_t first = 0;
  std::size_t last = 0;
  double length = 0.0;  // of `progress`
  double translation_m = kUnknown;
  double rotation_rad = kUnknown;  // NaN without rotation
};

/// From every pair to that whose `progress` (not falling: path_m() or elapsed_s()) is nearest to
/// `length` > 0 further on, where that is within 10 % of it; none from where less than `length` is
/// left. With rotation the error is that of the motion in body axes, so that no turn of the whole
/// path changes it; without, that of the displacement along the axes.
std::vector<SegmentError> segment_errors(const PosePairs& pairs,
                                         const std::vector<double>& progress, double length);

/// Normalised estimation error squared, e^T P^-1 e: of chi-square with `dof` where the covariance P
/// is right. Pairs whose covariance is unknown or not positive definite are left out.
struct NeesSummary {
  int dof = 0;
  std::size_t count = 0;
  std::size_t left_out = 0;
  double mean = kUnknown;             // `dof` is right
  double share_inside_95 = kUnknown;  // of the pairs, within the ellipse of 95 %
};

/// Of x and y, and of x, y and yaw. `pairs` as associated, not aligned: the truth is brought to the
/// estimate, whose axes the covariance is in.
NeesSummary position_nees(const PosePairs& pairs, const Alignment& alignment);
NeesSummary pose_nees(const PosePairs& pairs, const Alignment& alignment);

}  // namespace lsv
