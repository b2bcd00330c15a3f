// SPDX-License-Identifier: BSD-3-Clause
// A body that drives on a plane without slipping sideways, with its motion known exactly: the body
// frame has x forward, y left, z up (REP-103), its origin on the axle; positive yaw is counter-
// clockwise; a positive yaw rate turns left. Starts at the origin, heading along ground x.
// Way and heading are closed forms; the place is their integral, to 1e-10 m.
// Pure functions of the segments, any thread.
#pragma once

#include <vector>

namespace lsv::sim {

/// A stretch of time in which speed and yaw rate change smoothly (3u^2 - 2u^3) from those of the
/// segment before, at first zero, to these.
struct DriveSegment {
  double duration_s = 0.0;  // > 0
  double speed_m_s = 0.0;   // negative: backwards
  double yaw_rate_rad_s = 0.0;
};

struct BodyWay {
  double way_m = 0.0;    // driven, backwards negative
  double yaw_rad = 0.0;  // counts full turns
};

struct BodyPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

class BodyDrive {
 public:
  /// At least one segment.
  explicit BodyDrive(const std::vector<DriveSegment>& segments);

  /// At rest before time 0 and after the end.
  BodyPose pose(double time_s) const;
  /// Without the quadrature of the place.
  BodyWay way(double time_s) const;
  double duration_s() const { return duration_s_; }

 private:
  struct Piece {
    DriveSegment to;
    double from_speed_m_s = 0.0;
    double from_yaw_rate_rad_s = 0.0;
    double begin_s = 0.0;
    BodyWay begin{};
    std::vector<BodyPose> places{};  // at every kMark_s of the piece, the first at its beginning
  };
  /// The piece of a time, and the time since it began.
  struct Moment {
    const Piece* piece;
    double since_s;
  };
  Moment moment(double time_s) const;
  static BodyWay way_after(const Piece& piece, double since_s);
  static BodyPose pose_after(const Piece& piece, double since_s);
  /// From one place of a piece to another, by quadrature.
  static BodyPose moved(const Piece& piece, const BodyPose& from, double from_s, double to_s);

  std::vector<Piece> pieces_;
  double duration_s_ = 0.0;
};

/// Curves to both sides one after the other: the yaw rate swings between +-`yaw_rate_rad_s`, each
/// swing over half a period. Begins and ends at rest.
BodyDrive slalom(double duration_s, double speed_m_s, double yaw_rate_rad_s, double period_s);

/// Straight ahead, begins and ends at rest.
BodyDrive straight(double duration_s, double speed_m_s);

/// To the left along one circle, already moving at the start and still at the end.
BodyDrive circle(double duration_s, double speed_m_s, double radius_m);

/// Straight, left, straight, back, right, slalom: what a calibration should be driven with.
BodyDrive figure_drive(double duration_s, double speed_m_s, double yaw_rate_rad_s);

}  // namespace lsv::sim
