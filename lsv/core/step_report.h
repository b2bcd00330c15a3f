// SPDX-License-Identifier: BSD-3-Clause
// What the odometer says about one frame: the row of every output.
#pragma once

#include <cstdint>
#include <string_view>

#include "lsv/core/deformation.h"
#include "lsv/core/motion.h"
#include "lsv/core/shift.h"
#include "lsv/core/stamp.h"

namespace lsv {

/// How the shift was found.
enum class Search {
  none,        // it was not
  predicted,   // near where the motion so far led to expect it
  full_range,  // among all lags: at the start, or because the prediction failed
};

/// Whether the ground moves, as far as can be told from the position.
enum class MotionState {
  unknown,  // too few frames yet
  at_rest,  // has not left a place, within the errors, for 50 frames
  moving,
};

/// Optics with this share of the image static want cleaning.
inline constexpr double kDirtyShare = 0.2;

std::string_view word(Search search);
std::string_view word(MotionState motion);

struct StepReport {
  std::int64_t frame = 0;  // index of this frame in its source
  Stamp stamp{};           // of this frame
  /// Between the two frames of the shift: back to the last accepted frame, so that the accepted
  /// shifts add up to the position; 0 for the first.
  std::int64_t dt_ns = 0;
  Shift shift{};              // over dt_ns; numbers are NaN unless status is ok
  SensorVelocity velocity{};  // mean over dt_ns; NaN unless shift.status is ok
  SensorPosition position{};  // held, not advanced, when shift.status is not ok
  Search search = Search::none;
  /// Index of the frame that this one was measured against; -1 when there is none.
  std::int64_t keyframe = -1;
  /// Counts the times that the ground was lost for good: what was travelled between two segments is
  /// not in the position.
  std::int64_t segment = 0;
  MotionState motion = MotionState::unknown;
  /// Over dt_ns; measured on request (TrackConfig::measure_deformation) with an accepted shift.
  Deformation deformation{};
  /// Share of the image in which what does not move with the ground (dirt, uneven light) outweighs
  /// what does; NaN until enough ground was seen. See kDirtyShare.
  double static_share = kUnknown;
};

}  // namespace lsv
