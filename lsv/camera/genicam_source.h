// SPDX-License-Identifier: BSD-3-Clause
// A GenICam camera (GigE Vision, USB3 Vision) as a live source, through Aravis.
//
// Frames come as the camera sends them: ids and stamps unjudged, frames with missing packets
// flagged `damaged` with the pixels that arrived and old ones elsewhere. A frame that lost its
// first packet, which carries id, stamp and size, is not delivered. Pixels are copied into the
// caller's frame, 16-bit ones into the machine's byte order. `arrival_ns` is when the first packet
// came, on the monotonic clock. The code here allocates nothing per frame; Aravis does, on its own
// thread.
#pragma once

#include <memory>
#include <string>

#include "lsv/camera/camera_options.h"
#include "lsv/core/result.h"
#include "lsv/stream/live_source.h"

namespace lsv {

/// `name`: the address of a camera ("127.0.0.1"), which opens in milliseconds, its identity as in
/// list_genicam_cameras() or its serial number, which takes a second more, or "" for the first that
/// answers. The camera streams from here on. Errors name the camera and the feature:
/// invalid_argument where it cannot do what `options` ask, bad_input where it does not answer,
/// unsupported for its pixel format.
/// Destroying the source takes at most 0.3 s, also when the camera is gone.
Result<std::unique_ptr<LiveSource>> open_genicam(const std::string& name,
                                                 const CameraOptions& options);

}  // namespace lsv
