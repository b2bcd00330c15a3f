// SPDX-License-Identifier: BSD-3-Clause
#include "tools/calibrated_frames.h"

#include <cstdio>
#include <utility>

#include "calibration/calibration_io.h"
#include "calibration/sensor_maps_io.h"
#include "lsv/sensor_setup.h"

namespace lsv::cli {

Result<std::unique_ptr<FrameSource>> open_calibrated_frames(const std::vector<std::string>& frames,
                                                            TrackSettings& track) {
  const std::string& path = track.calibration_path;
  if (!path.empty()) {
    Result<Calibration> calibration = load_calibration(path);
    if (!calibration) return calibration.error();
    track.config.calibration = std::move(calibration).value();
  }
  Result<std::unique_ptr<FrameSource>> source = open_frames(frames, track.source);
  if (!source) return source.error();
  const SourceInfo& info = source.value()->info();
  for (const std::string& warning : info.warnings)
    std::fprintf(stderr, "lsv: warning: %s\n", warning.c_str());
  if (!path.empty()) {
    const Result<void> set =
        set_sensor_maps(track.config, path, info.whole_format, track.source.roi);
    if (!set) return set.error();
  }
  return source;
}

std::vector<std::string> inputs_of(const SourceInfo& source, const TrackSettings& track) {
  std::vector<std::string> out = source.files;
  for (const std::string& path :
       {track.calibration_path, track.source.timestamps_path,
        sensor_maps_path(track.config.calibration, track.calibration_path)}) {
    if (!path.empty()) out.push_back(path);
  }
  return out;
}

}  // namespace lsv::cli
