// SPDX-License-Identifier: BSD-3-Clause
// Calibration and sensor maps from their files into the settings of the pipeline, for the frames
// that are to come: the one place where a program takes them from.
//
//   lsv::TrackConfig config;
//   const auto ready = lsv::set_calibration(config, "cam0/calibration.toml", whole_frames, region);
//
// Errors: bad_input, one sentence that names the file; `config` is then as it was.
#pragma once

#include <optional>
#include <string>

#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"

namespace lsv {

/// Loads the calibration at `path` and the maps that it names. `whole` is the format of the frames
/// as the camera gives them, and must be that of [format] where the calibration has one; `roi` is
/// the region of them that will be tracked, and the maps are cut to it.
Result<void> set_calibration(TrackConfig& config, const std::string& path, const FrameFormat& whole,
                             const std::optional<Roi>& roi = std::nullopt);

/// The second half of it, for a program that reads the calibration before it knows the frames:
/// `config.calibration` is what load_calibration(path) gave.
Result<void> set_sensor_maps(TrackConfig& config, const std::string& path, const FrameFormat& whole,
                             const std::optional<Roi>& roi = std::nullopt);

}  // namespace lsv
