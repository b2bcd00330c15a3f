// SPDX-License-Identifier: BSD-3-Clause
// What the odometer says about one frame: the row of every output.
#pragma once

#include <cstdint>

#include "lsv/core/motion.h"
#include "lsv/core/shift.h"
#include "lsv/core/stamp.h"

namespace lsv {

struct StepReport {
  std::int64_t frame = 0;     // index of this frame in its source
  Stamp stamp{};              // of this frame
  std::int64_t dt_ns = 0;     // between the two frames of the shift; 0 for the first
  Shift shift{};              // from the frame before; numbers are NaN unless status is ok
  SensorVelocity velocity{};  // NaN unless shift.status is ok
  SensorPosition position{};  // held, not advanced, when shift.status is not ok
};

}  // namespace lsv
