// SPDX-License-Identifier: BSD-3-Clause
// From the name of a camera to a camera that we control, set as asked, with every setting read
// back. Internal to lsv/camera.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "lsv/camera/camera_options.h"
#include "lsv/camera/glib_handles.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/stream/live_source.h"

namespace lsv {

struct GenicamSetup {
  ObjectPtr<ArvCamera> camera;
  std::string name;  // for messages: "genicam:127.0.0.1"
  LiveSourceInfo info{};
  std::size_t payload_bytes = 0;
};

/// `name` as for open_genicam().
Result<GenicamSetup> set_up_genicam(const std::string& name, const CameraOptions& options);

}  // namespace lsv
