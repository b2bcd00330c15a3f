// SPDX-License-Identifier: BSD-3-Clause
// The settings of `lsv live`: those of measuring, as for `lsv track`, of the camera and of the
// stream.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "lsv/camera/camera_options.h"
#include "lsv/stream/reopening_source.h"
#include "lsv/stream/stream_options.h"
#include "tools/settings.h"
#include "tools/track_settings.h"

namespace lsv::cli {

struct LiveSettings {
  TrackSettings track;
  CameraOptions camera;
  StreamOptions stream;
  ReopenPolicy reopening;

  // In the units of people, until resolve_live() takes them over.
  std::optional<double> exposure_us{};
  std::optional<double> frame_retention_ms{};
  std::optional<double> lost_after_ms{};
  std::optional<int> buffers{};
  std::optional<int> queue_frames{};
  std::optional<int> reopen_attempts{};
  std::optional<int> fifo_priority{};
};

/// `target` must outlive `settings`.
void add_live_settings(CLI::App& command, Settings& settings, LiveSettings& target);

/// After Settings::resolve(). invalid_argument for what the camera and the stream do not check.
Result<void> resolve_live(LiveSettings& live);

}  // namespace lsv::cli
