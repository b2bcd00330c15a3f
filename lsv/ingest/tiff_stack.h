// SPDX-License-Identifier: BSD-3-Clause
// The pages of one TIFF file as a stream of frames.
#pragma once

#include <memory>
#include <string>

#include "lsv/ingest/frame_stream.h"
#include "lsv/ingest/image_decode.h"

namespace lsv {

Result<std::unique_ptr<FrameStream>> open_tiff_stack(const std::string& path,
                                                     const DecodeOptions& options);

}  // namespace lsv
