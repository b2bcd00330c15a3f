// SPDX-License-Identifier: BSD-3-Clause
// rover.toml: what `lsv fuse` must know of a rover. Keys: docs/formats.md.
#pragma once

#include <string>
#include <string_view>

#include "fusion/rover_config.h"
#include "lsv/core/result.h"

namespace lsv::cli {

struct RoverFile {
  FusionConfig config;
  std::string sha256;
};

/// Whether the name of a sensor can stand in a line of a table and in TOML: not empty, no comma, no
/// quote, nothing that is no character of a line, at most 64 bytes.
bool is_sensor_name(std::string_view name);
inline constexpr const char* kSensorNameRule =
    "must be 1 to 64 characters without comma, quote or line break";

/// bad_input, naming file, line and key, for anything that is not such a file or out of range.
Result<RoverFile> read_rover(const std::string& path);

}  // namespace lsv::cli
