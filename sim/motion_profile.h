// SPDX-License-Identifier: BSD-3-Clause
// How the speckle pattern moves over the sensor: position and velocity at the middle of the
// exposure of each frame. Unit: pixels and pixels per frame interval. Positive x: the pattern
// moved to a larger column; positive y: to a larger row. The shift from frame k-1 to frame k is
// position(k) - position(k-1). Every profile here starts at (0, 0) but the table of a file.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lsv/core/result.h"

namespace lsv::sim {

struct PatternMotion {
  double x_px = 0.0;
  double y_px = 0.0;
  double vx_px_per_frame = 0.0;  // for the exposure blur
  double vy_px_per_frame = 0.0;
};

/// Defined for frames 0, 1, 2, ...; a pure function, safe from any thread.
using MotionProfile = std::function<PatternMotion(std::int64_t frame)>;

MotionProfile parked();
MotionProfile constant_velocity(double vx_px_per_frame, double vy_px_per_frame);

/// Velocity (vx, vy) * cos(2 pi frame / period): never faster than the velocity given.
/// `period_frames` > 0.
MotionProfile sinusoid(double vx_px_per_frame, double vy_px_per_frame, double period_frames);

/// A stretch of time in which the velocity changes smoothly (3u^2 - 2u^3) from that of the
/// segment before, at first zero, to the one given.
struct VelocitySegment {
  double frames = 0.0;  // > 0
  double vx_px_per_frame = 0.0;
  double vy_px_per_frame = 0.0;
};
/// After the last segment its velocity is kept.
MotionProfile piecewise(const std::vector<VelocitySegment>& segments);

/// A drive of `frames` frames: rest, speeding up to (vx, vy), slowing down, a stop of a tenth of
/// the time, a reversal to (-0.8 vx, 0.5 vy), and rest at the end.
MotionProfile drive(double vx_px_per_frame, double vy_px_per_frame, double frames);

/// Independent shifts, uniform in [-max_dx, max_dx] x [-max_dy, max_dy], for frames up to
/// `frames` - 1 (held afterwards). The velocity is the mean of the shifts before and after.
MotionProfile random_shifts(double max_dx_px, double max_dy_px, std::int64_t frames,
                            std::uint64_t seed);

/// The columns x_px and y_px of a comma-separated file, one row per frame: lines that start with
/// '#' are skipped, the first other line names the columns. What `lsv simulate` writes as
/// truth.csv can be read back. The velocity is the mean of the shifts before and after.
struct MotionTable {
  MotionProfile profile;
  std::int64_t frames = 0;
};
Result<MotionTable> read_motion_table(const std::string& path);

}  // namespace lsv::sim
