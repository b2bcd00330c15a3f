// SPDX-License-Identifier: BSD-3-Clause
// Frames opened together with the calibration of the camera that took them: the one way in which
// commands load a calibration and its sensor maps.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lsv/core/result.h"
#include "lsv/ingest/frame_source.h"
#include "tools/track_settings.h"

namespace lsv::cli {

/// Puts calibration and sensor maps into `track.config`, unless track.calibration_path is empty,
/// and prints the warnings of the source. The calibration is read before the frames, which may be a
/// pipe that keeps one waiting.
Result<std::unique_ptr<FrameSource>> open_calibrated_frames(const std::vector<std::string>& frames,
                                                            TrackSettings& track);

/// Every file that was read, so that no output overwrites one.
std::vector<std::string> inputs_of(const SourceInfo& source, const TrackSettings& track);

}  // namespace lsv::cli
