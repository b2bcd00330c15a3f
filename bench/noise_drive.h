// SPDX-License-Identifier: BSD-3-Clause
// Steady drives through the odometer, for the part of calibration/noise_model.h that is about
// tracking: errors from frame to frame, and of the travel over many frames.
#pragma once

#include <vector>

#include "bench/noise_points.h"

namespace lsv::bench {

/// The shift of a point is that per frame, along x.
const std::vector<NoisePoint>& noise_drives();

struct DriveErrors {
  int refused = 0;
  double step_x_px = 0.0;  // RMS of the error from frame to frame
  double step_y_px = 0.0;
  double travel_px = 0.0;  // RMS over both axes, after kTravelFrames
  double frames_per_keyframe = 0.0;
};

inline constexpr int kTravelFrames = 50;

/// `drives` drives over new ground of `frames` frames each.
DriveErrors simulate_drive(const NoisePoint& point, int drives, int frames);

}  // namespace lsv::bench
