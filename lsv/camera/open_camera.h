// SPDX-License-Identifier: BSD-3-Clause
// One word for every camera that lsv can open:
//   genicam:ADDRESS-OR-ID   a GenICam camera (GigE Vision, USB3 Vision)
//   v4l:/dev/video0         a Video4Linux camera
//   gst:PIPELINE            what a GStreamer pipeline ends in
#pragma once

#include <memory>
#include <string>

#include "lsv/camera/camera_options.h"
#include "lsv/core/result.h"
#include "lsv/stream/live_source.h"

namespace lsv {

inline constexpr const char* kCameraHelp = "genicam:ADDRESS-OR-ID, v4l:/dev/videoN or gst:PIPELINE";

/// invalid_argument for a word of another kind; otherwise as the source of that kind.
Result<std::unique_ptr<LiveSource>> open_camera(const std::string& source,
                                                const CameraOptions& options);

/// For programs: from now on GLib, Aravis and GStreamer write nothing to standard error, where the
/// program has its own voice. Process-wide.
void silence_camera_libraries();

}  // namespace lsv
