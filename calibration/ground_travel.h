// SPDX-License-Identifier: BSD-3-Clause
// Travel over the ground from a link of a track and the headings at both ends:
//   D = sum R(yaw(f)) d,   yaw(f) = yaw + f turn
// with R(f turn) as a series to the third power of the turn, which leaves turn^4 / 24.
// Internal to calibration/.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "calibration/track_links.h"

namespace lsv {

/// Headings further apart than this do not tell how the body turned in between.
inline constexpr double kLargestTurn_rad = 0.3;

inline Eigen::Matrix2d rotation(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

/// A quarter turn to the left.
inline Eigen::Vector2d left_of(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

inline double turn_between(double from_rad, double to_rad) {
  return std::remainder(to_rad - from_rad, 2.0 * std::numbers::pi);
}

struct GroundTravel {
  Eigen::Vector2d d_m;      // turned by the heading alone: mount yaw 0, scale 1
  Eigen::Vector2d by_from;  // derivative by the heading at the beginning, m/rad
  Eigen::Vector2d by_to;    // and at the end
};

inline GroundTravel ground_travel(const TrackLink& link, double from_rad, double turn_rad) {
  const auto moment = [&link](std::size_t n) {
    return Eigen::Vector2d(link.moments_m[n][0], link.moments_m[n][1]);
  };
  const double t = turn_rad;
  const Eigen::Vector2d straight = moment(0) - 0.5 * t * t * moment(2);
  const Eigen::Vector2d across = t * moment(1) - t * t * t / 6.0 * moment(3);
  const Eigen::Vector2d straight_by_turn = -t * moment(2);
  const Eigen::Vector2d across_by_turn = moment(1) - 0.5 * t * t * moment(3);
  const Eigen::Matrix2d heading = rotation(from_rad);
  GroundTravel out;
  out.d_m = heading * (straight + left_of(across));
  out.by_to = heading * (straight_by_turn + left_of(across_by_turn));
  out.by_from = left_of(out.d_m) - out.by_to;
  return out;
}

/// Of the travel on the ground, at a heading about the middle of the link.
inline Eigen::Matrix2d travel_covariance(const TrackLink& link, double yaw_rad) {
  Eigen::Matrix2d sensor;
  sensor << link.xx_m2, link.xy_m2, link.xy_m2, link.yy_m2;
  const Eigen::Matrix2d turn = rotation(yaw_rad);
  return turn * sensor * turn.transpose();
}

}  // namespace lsv
