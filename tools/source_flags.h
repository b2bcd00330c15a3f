// SPDX-License-Identifier: BSD-3-Clause
// The flags that say which frames to read and when they were taken, shared by every command that
// reads frames.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lsv/frame_source.h"

namespace lsv::cli {

struct SourceFlags {
  std::vector<std::string> frames;
  std::string raw;  // texts, parsed by source_options()
  std::string roi;
  SourceOptions options;
};

/// Adds FRAMES and the flags to `command`; `flags` outlives the parse.
void add_source_flags(CLI::App& command, SourceFlags& flags);

/// The options with --raw and --roi parsed.
Result<SourceOptions> source_options(const SourceFlags& flags);

}  // namespace lsv::cli
