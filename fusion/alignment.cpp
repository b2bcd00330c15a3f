// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/alignment.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fusion/rotation.h"

namespace lsv {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Of what the spread allows: a relation below it is rounding.
constexpr double kNoRelation = 1e-12;

/// Sums over the pairs about their means.
struct Moments {
  Vector3d mean_estimate_m = Vector3d::Zero();
  Vector3d mean_truth_m = Vector3d::Zero();
  Matrix3d cross_m2 = Matrix3d::Zero();  // sum of truth estimate^T
  double estimate_m2 = 0.0;
  double truth_m2 = 0.0;
  /// What rounding of the coordinates puts into `cross_m2`.
  double rounding_m2 = 0.0;
  bool is_one_place = false;  // in one of the two there is no extent
};

Moments moments_of(const PosePairs& pairs) {
  Moments out;
  const auto n = static_cast<double>(pairs.size());
  double largest_m = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Vector3d estimate = position_of(pairs.estimate[i]);
    const Vector3d truth = position_of(pairs.truth[i]);
    out.mean_estimate_m += estimate / n;
    out.mean_truth_m += truth / n;
    largest_m = std::max({largest_m, estimate.cwiseAbs().maxCoeff(), truth.cwiseAbs().maxCoeff()});
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Vector3d estimate = position_of(pairs.estimate[i]) - out.mean_estimate_m;
    const Vector3d truth = position_of(pairs.truth[i]) - out.mean_truth_m;
    out.cross_m2 += truth * estimate.transpose();
    out.estimate_m2 += estimate.squaredNorm();
    out.truth_m2 += truth.squaredNorm();
  }
  constexpr double kRoundings = 16.0;
  const double rounding_m =
      kRoundings * std::numeric_limits<double>::epsilon() * largest_m * std::sqrt(n);
  out.is_one_place = std::sqrt(std::min(out.estimate_m2, out.truth_m2)) <= rounding_m;
  out.rounding_m2 = rounding_m * (std::sqrt(out.estimate_m2) + std::sqrt(out.truth_m2));
  return out;
}

bool is_related(double correlation_m2, const Moments& m) {
  return correlation_m2 >
         kNoRelation * std::sqrt(m.estimate_m2) * std::sqrt(m.truth_m2) + m.rounding_m2;
}

/// The smallest turn that takes the direction `from` to `to`.
Quaterniond smallest_turn(const Vector3d& from, const Vector3d& to) {
  constexpr double kOpposite = -1.0 + 1e-12;
  if (from.dot(to) > kOpposite) return Quaterniond::FromTwoVectors(from, to);
  // Half a turn about any axis across the line: upright where that is possible.
  Vector3d axis = Vector3d::UnitZ() - from.z() * from;
  if (axis.norm() < 1e-6) axis = Vector3d::UnitX() - from.x() * from;
  axis.normalize();
  return {0.0, axis.x(), axis.y(), axis.z()};
}

void shift_means_together(const Moments& m, Alignment& out) {
  const Vector3d shift = m.mean_truth_m - out.scale * (eigen_of(out.rotation) * m.mean_estimate_m);
  out.translation_m = {shift.x(), shift.y(), shift.z()};
}

/// In the complex plane: the angle of sum(truth conj(estimate)).
void fit_plane(const Moments& m, Alignment& out) {
  const double dot_m2 = m.cross_m2(0, 0) + m.cross_m2(1, 1);
  const double cross_m2 = m.cross_m2(1, 0) - m.cross_m2(0, 1);
  if (m.is_one_place || !is_related(std::hypot(dot_m2, cross_m2), m)) {
    out.status = AlignmentStatus::free_turn;
  } else {
    const double half_rad = 0.5 * std::atan2(cross_m2, dot_m2);
    out.rotation = {.x = 0.0, .y = 0.0, .z = std::sin(half_rad), .w = std::cos(half_rad)};
  }
  shift_means_together(m, out);
  out.translation_m[2] = 0.0;
}

void fit_space(const Moments& m, bool has_scale, Alignment& out) {
  const Eigen::JacobiSVD<Matrix3d> svd(m.cross_m2, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d& strength_m2 = svd.singularValues();
  if (m.is_one_place || !is_related(strength_m2[0], m)) {
    out.status = AlignmentStatus::free_turn;
    shift_means_together(m, out);
    return;
  }
  const Matrix3d& to = svd.matrixU();
  const Matrix3d& from = svd.matrixV();
  double trace_m2 = strength_m2[0];
  if (strength_m2[1] <= kNoRelation * strength_m2[0] + m.rounding_m2) {
    out.status = AlignmentStatus::free_about_line;
    out.rotation = plain_of(smallest_turn(from.col(0), to.col(0)));
  } else {
    // Of a mirror image the weakest axis is given up (Umeyama's S).
    const double handedness = to.determinant() * from.determinant() < 0.0 ? -1.0 : 1.0;
    const Vector3d signs(1.0, 1.0, handedness);
    const Matrix3d turn = to * signs.asDiagonal() * from.transpose();
    out.rotation = plain_of(Quaterniond(turn).normalized());
    trace_m2 = strength_m2.dot(signs);
  }
  if (has_scale) out.scale = trace_m2 / m.estimate_m2;
  shift_means_together(m, out);
}

void meet_at_first(const PosePairs& pairs, Alignment& out) {
  if (pairs.has_rotation) {
    out.rotation = plain_of((eigen_of(pairs.truth.front().rotation) *
                             eigen_of(pairs.estimate.front().rotation).conjugate())
                                .normalized());
  } else {
    out.status = AlignmentStatus::free_turn;
  }
  const Vector3d shift = position_of(pairs.truth.front()) -
                         eigen_of(out.rotation) * position_of(pairs.estimate.front());
  out.translation_m = {shift.x(), shift.y(), shift.z()};
}

double sum_of_squares_m2(const PosePairs& pairs, const Alignment& alignment) {
  double out = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    out += (position_of(aligned(alignment, pairs.estimate[i])) - position_of(pairs.truth[i]))
               .squaredNorm();
  }
  return out;
}

}  // namespace

std::string_view word(AlignmentKind kind) {
  switch (kind) {
    case AlignmentKind::none:
      return "none";
    case AlignmentKind::origin:
      return "origin";
    case AlignmentKind::se2:
      return "se2";
    case AlignmentKind::se3:
      return "se3";
    case AlignmentKind::sim3:
      return "sim3";
  }
  return "none";
}

std::optional<AlignmentKind> alignment_kind(std::string_view text) {
  for (const AlignmentKind kind : kAllAlignmentKinds) {
    if (word(kind) == text) return kind;
  }
  return std::nullopt;
}

std::string_view word(AlignmentStatus status) {
  switch (status) {
    case AlignmentStatus::determined:
      return "determined";
    case AlignmentStatus::free_about_line:
      return "free_about_line";
    case AlignmentStatus::free_turn:
      return "free_turn";
  }
  return "determined";
}

Alignment align(const PosePairs& pairs, AlignmentKind kind) {
  Alignment out{.kind = kind};
  if (kind == AlignmentKind::none || pairs.size() == 0) return out;
  if (kind == AlignmentKind::origin) {
    meet_at_first(pairs, out);
    return out;
  }
  const Moments moments = moments_of(pairs);
  if (kind == AlignmentKind::se2)
    fit_plane(moments, out);
  else
    fit_space(moments, kind == AlignmentKind::sim3, out);
  // A fit is never worse than none, except by rounding: then none is the fit.
  const Alignment identity{.kind = kind, .status = out.status};
  if (sum_of_squares_m2(pairs, identity) <= sum_of_squares_m2(pairs, out)) return identity;
  return out;
}

TrajectoryPose aligned(const Alignment& alignment, const TrajectoryPose& pose) {
  const Quaterniond turn = eigen_of(alignment.rotation);
  const auto& [x_m, y_m, z_m] = alignment.translation_m;
  const Vector3d position = alignment.scale * (turn * position_of(pose)) + Vector3d(x_m, y_m, z_m);
  return {.stamp = pose.stamp,
          .x_m = position.x(),
          .y_m = position.y(),
          .z_m = position.z(),
          .rotation = plain_of(turn * eigen_of(pose.rotation))};
}

TrajectoryPose unaligned(const Alignment& alignment, const TrajectoryPose& pose) {
  const Quaterniond back = eigen_of(alignment.rotation).conjugate();
  const auto& [x_m, y_m, z_m] = alignment.translation_m;
  const Vector3d position =
      back * ((position_of(pose) - Vector3d(x_m, y_m, z_m)) / alignment.scale);
  return {.stamp = pose.stamp,
          .x_m = position.x(),
          .y_m = position.y(),
          .z_m = position.z(),
          .rotation = plain_of(back * eigen_of(pose.rotation))};
}

std::array<std::array<double, 3>, 3> rotation_matrix(const Quaternion& rotation) {
  const Matrix3d matrix = eigen_of(rotation).toRotationMatrix();
  std::array<std::array<double, 3>, 3> out{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      out[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = matrix(row, column);
  }
  return out;
}

}  // namespace lsv
