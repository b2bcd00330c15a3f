// SPDX-License-Identifier: BSD-3-Clause
// The sequences of `lsv calibrate camera`, read frame by frame into statistics.
#pragma once

#include <string>
#include <vector>

#include "calibration/camera_characterisation.h"
#include "lsv/core/result.h"
#include "lsv/ingest/frame_source.h"

namespace lsv::cli {

struct CameraFrames {
  LightSequence dark;
  std::vector<LightSequence> flats;
  std::vector<std::string> files;     // that were read
  std::vector<std::string> warnings;  // of the sources
  /// SHA-256 over the pixels of all frames, dark first, chained from frame to frame.
  std::string inputs_sha256;
};

/// `exposures_us`: one per flat, or none. An interrupt (tools/interrupt.h) ends the reading early.
Result<CameraFrames> read_camera_frames(const std::string& dark,
                                        const std::vector<std::string>& flats,
                                        const std::vector<double>& exposures_us,
                                        const SourceOptions& options);

}  // namespace lsv::cli
