// SPDX-License-Identifier: BSD-3-Clause
// What one frame adds to the path of the pattern over the sensor, in px: the output of the two
// ways to follow it (keyframe_odometry.h, frame_to_frame.h) before any scale is applied.
#pragma once

#include <cstdint>

#include "lsv/core/shift.h"
#include "lsv/core/stamp.h"
#include "lsv/core/step_report.h"

namespace lsv {

struct PatternStep {
  Shift shift;  // since the frame taken at `since`
  Stamp since{};
  Search search = Search::none;
  std::int64_t keyframe = -1;  // index of the frame it was measured against; -1: none
  std::int64_t segment = 0;
  MotionState motion = MotionState::unknown;
  Deformation deformation{};
  double static_share = kUnknown;  // see StepReport
  // The sum of the accepted shifts, and its covariance.
  double x_px = 0.0;
  double y_px = 0.0;
  ShiftCovariance position_cov{0.0, 0.0, 0.0};
};

}  // namespace lsv
