// SPDX-License-Identifier: BSD-3-Clause
// Headerless frames from a file or from standard input as a stream of frames.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "lsv/ingest/frame_source.h"
#include "lsv/ingest/frame_stream.h"

namespace lsv {

/// The path "-" is standard input, which stays open. A file must hold the header and a whole
/// number of frames; a stream that ends inside a frame is an error at that frame.
Result<std::unique_ptr<FrameStream>> open_raw(const std::string& path, const RawFormat& raw,
                                              std::int64_t max_pixels);

std::int64_t bytes_per_frame(const FrameFormat& format);

/// Zero, or above `max_pixels`, is an error of usage: the size was typed.
Result<void> check_raw_size(const std::string& name, const RawFormat& raw, std::int64_t max_pixels);

/// `bytes` holds bytes_per_frame(format) bytes, little-endian.
void copy_raw_frame(std::span<const std::uint8_t> bytes, const FrameFormat& format, Frame& out);

/// .raw .bin .y8 .y16, upper or lower case.
bool is_raw_path(const std::string& path);

}  // namespace lsv
