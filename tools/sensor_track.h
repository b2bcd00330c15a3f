// SPDX-License-Identifier: BSD-3-Clause
// A track that `lsv track --csv` wrote, as travel of the sensor under a calibration that may be
// another than that of the tracking: the shifts in px are read (time_s, dt_s, dx_px, dy_px, their
// sigmas, status), not the positions.
#pragma once

#include <cstddef>
#include <string>

#include "calibration/drive.h"
#include "lsv/core/calibration.h"
#include "lsv/core/result.h"

namespace lsv::cli {

struct TrackFile {
  SensorTrack steps;
  std::size_t refused = 0;  // rows
  std::string sha256;
};

/// bad_input, naming file and line, for a table that is malformed, whose times do not increase, or
/// whose dt_s reaches back before the end of the shift accepted before.
Result<TrackFile> read_sensor_track(const std::string& path, const Calibration& calibration);

}  // namespace lsv::cli
