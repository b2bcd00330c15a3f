// SPDX-License-Identifier: BSD-3-Clause
// Image files, one frame each, as a stream of frames. In a numbered family (numbered_names.h)
// the index of a frame is its number minus the first number, so that a hole in the numbers is a
// missing frame; other names are frames 0, 1, 2, ...
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lsv/ingest/frame_stream.h"
#include "lsv/ingest/image_decode.h"

namespace lsv {

enum class ListOrder {
  natural,  // a folder or a pattern: the list has no order of its own
  as_given  // kept, unless it is one numbered family: shells put img10 before img2
};

/// `paths` is not empty and all of them have a known image extension of the same kind.
Result<std::unique_ptr<FrameStream>> open_image_sequence(std::vector<std::string> paths,
                                                         ListOrder order, bool ignore_numbers,
                                                         const DecodeOptions& options);

}  // namespace lsv
