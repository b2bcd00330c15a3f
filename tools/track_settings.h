// SPDX-License-Identifier: BSD-3-Clause
// The settings of `lsv track`: which flag, variable and configuration key sets which field.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "lsv/core/config.h"
#include "lsv/ingest/frame_source.h"
#include "tools/settings.h"

namespace lsv::cli {

/// What FRAMES may be, for --help.
inline constexpr const char* kFramesHelp =
    "A folder, image files, a quoted pattern, a TIFF stack, a raw file, a video, a recording "
    "(.mcap), or - for raw frames on standard input";

struct TrackSettings {
  TrackConfig config;
  SourceOptions source;
  std::string calibration_path;
  double max_rejected_share = 0.1;  // above it the exit code is kExitLowQuality
};

/// Which frames to read and when they were taken: shared by every command that reads frames.
void add_source_settings(CLI::App& command, Settings& settings, SourceOptions& source);

/// How the pattern is measured; not where the frames come from. `target` must outlive `settings`.
void add_measuring_settings(CLI::App& command, Settings& settings, TrackSettings& target);

/// Both.
void add_track_settings(CLI::App& command, Settings& settings, TrackSettings& target);

}  // namespace lsv::cli
