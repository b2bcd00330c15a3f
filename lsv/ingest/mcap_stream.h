// SPDX-License-Identifier: BSD-3-Clause
// A recording as a stream of frames with their own indices and stamps.
#pragma once

#include <memory>
#include <string>

#include "lsv/ingest/frame_stream.h"
#include "lsv/ingest/recording.h"

namespace lsv {

Result<std::unique_ptr<FrameStream>> open_mcap_stream(const std::string& path,
                                                      const RecordingOptions& options);

}  // namespace lsv
