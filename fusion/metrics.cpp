// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/metrics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "fusion/chi_square.h"
#include "fusion/rotation.h"

namespace lsv {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kLengthTolerance = 0.1;
constexpr double kRounding = 1e-9;
constexpr double kOutside = 0.05;

double wrapped_rad(double angle_rad) {
  const double out = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return out <= -std::numbers::pi ? out + 2.0 * std::numbers::pi : out;
}

/// Between two rotations, 0 to pi; exactly 0 between equal ones.
double angle_between_rad(const Quaterniond& a, const Quaterniond& b) {
  const Quaterniond turn = a.conjugate() * b;
  return 2.0 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
}

/// The motion between two poses, seen from the first.
struct Motion {
  Vector3d translation_m;
  Quaterniond rotation;
};

Motion motion_between(const TrajectoryPose& first, const TrajectoryPose& last) {
  const Quaterniond back = eigen_of(first.rotation).conjugate();
  return {back * (position_of(last) - position_of(first)), back * eigen_of(last.rotation)};
}

SegmentError segment_error(const PosePairs& pairs, std::size_t first, std::size_t last) {
  SegmentError out{.first = first, .last = last};
  if (!pairs.has_rotation) {
    const Vector3d estimate =
        position_of(pairs.estimate[last]) - position_of(pairs.estimate[first]);
    const Vector3d truth = position_of(pairs.truth[last]) - position_of(pairs.truth[first]);
    out.translation_m = (estimate - truth).norm();
    return out;
  }
  const Motion estimate = motion_between(pairs.estimate[first], pairs.estimate[last]);
  const Motion truth = motion_between(pairs.truth[first], pairs.truth[last]);
  out.translation_m = (estimate.translation_m - truth.translation_m).norm();
  out.rotation_rad = angle_between_rad(truth.rotation, estimate.rotation);
  return out;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

template <int n>
using Vector = Eigen::Matrix<double, n, 1>;
template <int n>
using Matrix = Eigen::Matrix<double, n, n>;

/// Nothing where the covariance is none.
template <int n>
std::optional<double> nees(const Vector<n>& error, const Matrix<n>& covariance) {
  if (!covariance.allFinite() || !error.allFinite()) return std::nullopt;
  const Eigen::LLT<Matrix<n>> root(covariance);
  if (root.info() != Eigen::Success) return std::nullopt;
  const double out = root.matrixL().solve(error).squaredNorm();
  return std::isfinite(out) ? std::optional(out) : std::nullopt;
}

template <int n, typename NeesOf>
NeesSummary summary_of(const PosePairs& pairs, NeesOf nees_of) {
  NeesSummary out{.dof = n};
  const double limit = chi_square_limit(kOutside, n);
  double sum = 0.0;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < pairs.covariances.size(); ++i) {
    const std::optional<double> value = nees_of(i);
    if (!value) {
      ++out.left_out;
      continue;
    }
    ++out.count;
    sum += *value;
    if (*value <= limit) ++inside;
  }
  if (out.count == 0) return out;
  out.mean = sum / static_cast<double>(out.count);
  out.share_inside_95 = static_cast<double>(inside) / static_cast<double>(out.count);
  return out;
}

}  // namespace

ErrorStatistics statistics_of(const std::vector<double>& values) {
  ErrorStatistics out{.count = values.size()};
  if (values.empty()) return out;
  const auto n = static_cast<double>(values.size());
  double sum = 0.0;
  double squares = 0.0;
  out.max = 0.0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
    out.max = std::max(out.max, std::abs(value));
  }
  out.mean = sum / n;
  out.rmse = std::sqrt(squares / n);
  double about_mean = 0.0;
  for (const double value : values) about_mean += (value - out.mean) * (value - out.mean);
  out.sd = std::sqrt(about_mean / n);
  out.median = median_of(values);
  return out;
}

AbsoluteErrors absolute_errors(const PosePairs& pairs) {
  AbsoluteErrors out;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const TrajectoryPose& estimate = pairs.estimate[i];
    const TrajectoryPose& truth = pairs.truth[i];
    out.position_m.push_back((position_of(estimate) - position_of(truth)).norm());
    out.rotation_rad.push_back(
        angle_between_rad(eigen_of(truth.rotation), eigen_of(estimate.rotation)));
    out.heading_rad.push_back(
        wrapped_rad(heading_rad(estimate.rotation) - heading_rad(truth.rotation)));
  }
  return out;
}

std::vector<double> path_m(const PosePairs& pairs) {
  std::vector<double> out(pairs.size(), 0.0);
  for (std::size_t i = 1; i < out.size(); ++i)
    out[i] = out[i - 1] + (position_of(pairs.truth[i]) - position_of(pairs.truth[i - 1])).norm();
  return out;
}

std::vector<double> elapsed_s(const PosePairs& pairs) {
  std::vector<double> out;
  if (!pairs.has_time) return out;
  for (const TrajectoryPose& pose : pairs.truth)
    out.push_back(seconds_between(pairs.truth.front().stamp, pose.stamp));
  return out;
}

std::vector<SegmentError> segment_errors(const PosePairs& pairs,
                                         const std::vector<double>& progress, double length) {
  std::vector<SegmentError> out;
  std::size_t last = 1;
  for (std::size_t first = 0; first + 1 < progress.size(); ++first) {
    last = std::max(last, first + 1);
    const double goal = progress[first] + length;
    const auto off = [&](std::size_t i) { return std::abs(progress[i] - goal); };
    // Progress does not fall and neither does the goal: what is passed stays passed.
    while (last + 1 < progress.size() && progress[last] < goal) ++last;
    if (progress[last] < goal - kRounding * length) break;
    const bool is_before = last > first + 1 && off(last - 1) <= off(last);
    const std::size_t nearest = is_before ? last - 1 : last;
    if (!(off(nearest) <= kLengthTolerance * length)) continue;
    out.push_back(segment_error(pairs, first, nearest));
    out.back().length = progress[nearest] - progress[first];
  }
  return out;
}

NeesSummary position_nees(const PosePairs& pairs, const Alignment& alignment) {
  return summary_of<2>(pairs, [&](std::size_t i) {
    const TrajectoryPose truth = unaligned(alignment, pairs.truth[i]);
    const PlanarCovariance& cov = pairs.covariances[i];
    Matrix<2> covariance;
    covariance << cov.xx_m2, cov.xy_m2, cov.xy_m2, cov.yy_m2;
    return nees<2>({pairs.estimate[i].x_m - truth.x_m, pairs.estimate[i].y_m - truth.y_m},
                   covariance);
  });
}

NeesSummary pose_nees(const PosePairs& pairs, const Alignment& alignment) {
  return summary_of<3>(pairs, [&](std::size_t i) {
    const TrajectoryPose& estimate = pairs.estimate[i];
    const TrajectoryPose truth = unaligned(alignment, pairs.truth[i]);
    const PlanarCovariance& cov = pairs.covariances[i];
    Matrix<3> covariance;
    covariance << cov.xx_m2, cov.xy_m2, cov.xyaw_m_rad,  //
        cov.xy_m2, cov.yy_m2, cov.yyaw_m_rad,            //
        cov.xyaw_m_rad, cov.yyaw_m_rad, cov.yawyaw_rad2;
    const double yaw_rad =
        wrapped_rad(heading_rad(estimate.rotation) - heading_rad(truth.rotation));
    return nees<3>({estimate.x_m - truth.x_m, estimate.y_m - truth.y_m, yaw_rad}, covariance);
  });
}

}  // namespace lsv
