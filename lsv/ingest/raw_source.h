// SPDX-License-Identifier: BSD-3-Clause
// Headerless frames from a file or from standard input as a stream of frames.
#pragma once

#include <memory>
#include <string>

#include "lsv/ingest/frame_source.h"
#include "lsv/ingest/frame_stream.h"

namespace lsv {

/// The path "-" is standard input, which stays open. A file must hold the header and a whole
/// number of frames; a stream that ends inside a frame is an error at that frame.
Result<std::unique_ptr<FrameStream>> open_raw(const std::string& path, const RawFormat& raw,
                                              std::int64_t max_pixels);

}  // namespace lsv
