// SPDX-License-Identifier: BSD-3-Clause
// A video file (.avi .mkv .mp4 .mov) as a stream of 8-bit frames, through OpenCV and FFmpeg.
// Colour becomes luma; a codec that loses information is named in a warning, and a video of more
// than 8 bits is refused because the decoder would squeeze it. The frame rate and the number of
// frames in the container are hints of its writer: the first is never used as a time base, the
// second only to notice a video that ends early.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lsv/ingest/frame_stream.h"

namespace lsv {

bool is_video_path(const std::string& path);

Result<std::unique_ptr<FrameStream>> open_video(const std::string& path, std::int64_t max_pixels);

}  // namespace lsv
