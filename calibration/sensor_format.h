// SPDX-License-Identifier: BSD-3-Clause
// Whether frames are the ones that a calibration was made for.
#pragma once

#include <string>

#include "lsv/core/calibration.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"

namespace lsv {

/// bad_input when `whole`, the format of the frames before any region is cut out, contradicts
/// [format] of the calibration; a calibration without [format] fits all. `calibration_path` stands
/// for the file in the message.
Result<void> check_format(const Calibration& calibration, const std::string& calibration_path,
                          const FrameFormat& whole);

}  // namespace lsv
