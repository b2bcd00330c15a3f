// SPDX-License-Identifier: BSD-3-Clause
// From what the user typed to the files it means: folders and patterns are expanded.
#pragma once

#include <string>
#include <vector>

#include "lsv/core/result.h"
#include "lsv/ingest/image_sequence.h"

namespace lsv {

struct FramePaths {
  std::vector<std::string> files;  // not empty; existence is not promised
  ListOrder order = ListOrder::as_given;
};

/// One folder gives its image files, or its raw files when `raw`; one pattern (* ? [) its matches,
/// anything else itself.
Result<FramePaths> expand_frame_paths(const std::vector<std::string>& paths, bool raw);

/// Several files must all be images of one format.
Result<void> check_image_list(const std::vector<std::string>& files);

}  // namespace lsv
