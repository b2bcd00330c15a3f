// SPDX-License-Identifier: BSD-3-Clause
// rover.toml: what `lsv fuse` must know of a rover. Keys: docs/formats.md.
#pragma once

#include <string>

#include "fusion/rover_config.h"
#include "lsv/core/result.h"

namespace lsv::cli {

struct RoverFile {
  FusionConfig config;
  std::string sha256;
};

/// bad_input, naming file, line and key, for anything that is not such a file or out of range.
Result<RoverFile> read_rover(const std::string& path);

}  // namespace lsv::cli
