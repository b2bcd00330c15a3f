// SPDX-License-Identifier: BSD-3-Clause
// Cameras that speak Video4Linux, and whatever a GStreamer pipeline ends in, as live sources
// through OpenCV. Frames must be grey, 8 or 16 bits.
//
// OpenCV waits for a frame without a time-out, so that a thread of the source does, and keeps up to
// CameraOptions::buffers frames until they are grabbed; more are counted as lost. Ids are counted
// there, lost ones included. `camera_ns` is the stamp of the driver for Video4Linux; GStreamer's
// is not to be had, and the time of arrival stands for it.
#pragma once

#include <memory>
#include <string>

#include "lsv/camera/camera_options.h"
#include "lsv/core/result.h"
#include "lsv/stream/live_source.h"

namespace lsv {

/// `device`: "/dev/video0". Of the options region (its size alone), pixel format (Mono8 or Mono16)
/// and rate are set; exposure is refused. A camera that stops has to be opened anew.
Result<std::unique_ptr<LiveSource>> open_v4l(const std::string& device,
                                             const CameraOptions& options);

/// `pipeline` as for gst-launch-1.0, e.g. "videotestsrc ! video/x-raw,format=GRAY8"; " ! appsink"
/// is added where it is missing. Region, pixel format and exposure are refused, because the
/// pipeline says them; the rate stands in for one that the pipeline does not tell. When the
/// pipeline ends, so does the source.
Result<std::unique_ptr<LiveSource>> open_gstreamer(const std::string& pipeline,
                                                   const CameraOptions& options);

}  // namespace lsv
