// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/camera/open_camera.h"

#include <glib.h>

#include "lsv/camera/genicam_source.h"
#include "lsv/camera/video_camera_source.h"

namespace lsv {

Result<std::unique_ptr<LiveSource>> open_camera(const std::string& source,
                                                const CameraOptions& options) {
  const std::size_t colon = source.find(':');
  const std::string kind = source.substr(0, colon);
  const std::string name = colon == std::string::npos ? "" : source.substr(colon + 1);
  const bool named = colon != std::string::npos;
  if (named && kind == "genicam") return open_genicam(name, options);
  if (named && kind == "v4l") return open_v4l(name.empty() ? "/dev/video0" : name, options);
  if (named && kind == "gst") return open_gstreamer(name, options);
  return Error{ErrorCode::invalid_argument, "\"" + source + "\" is no camera: give " + kCameraHelp};
}

void silence_camera_libraries() {
  g_log_set_default_handler([](const gchar*, GLogLevelFlags, const gchar*, gpointer) {}, nullptr);
}

}  // namespace lsv
