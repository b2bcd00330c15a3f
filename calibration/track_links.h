// SPDX-License-Identifier: BSD-3-Clause
// A track cut at the times of a reference: what the sensor travelled between two poses of the body.
// The axes of the sensor turn on the way, so the travel is kept as moments over the time: with the
// heading known at both ends and taken to change evenly between them, the travel on the ground
// follows from them to the fourth order of the turn (calibration/ground_travel.h).
// Pure functions; they allocate.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "calibration/drive.h"

namespace lsv {

struct TrackLink {
  /// All of the time is covered by accepted shifts, and the poses are not so far apart that the
  /// heading between them is anyone's guess. Otherwise the rest means nothing.
  bool is_known = false;
  /// Sums of f^n (dx_m, dy_m), n = 0 to 3, f being the share of the time that has passed, 0 to 1.
  std::array<std::array<double, 2>, 4> moments_m{};
  double xx_m2 = 0.0;  // covariance of the sum
  double xy_m2 = 0.0;
  double yy_m2 = 0.0;
};

/// Poses at whose time the track knows where the sensor is: not in gaps, and not within shifts that
/// span refused frames. Indices into `reference`. `clock_offset_s` is added to the times of the
/// track.
std::vector<std::size_t> placed_poses(const BodyReference& reference, const SensorTrack& track,
                                      double clock_offset_s);

/// From each of `stamps` to the next.
std::vector<TrackLink> link_track(const std::vector<Stamp>& stamps, const SensorTrack& track,
                                  double clock_offset_s);

}  // namespace lsv
