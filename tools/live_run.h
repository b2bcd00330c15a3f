// SPDX-License-Identifier: BSD-3-Clause
// A camera measured while it runs, and recorded if that is asked for: what `lsv live` and
// `lsv record` share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "tools/live_settings.h"
#include "tools/track_outputs.h"

namespace lsv::cli {

struct LiveCommand {
  std::string source;
  std::string recording;  // file; empty: none
  bool compress = false;
  std::string config_path;
  std::string health_path;
  double seconds = 0.0;
  bool print_config = false;
  bool quiet = false;
  OutputPaths outputs;
  LiveSettings live;
  Settings settings;
};

/// Everything but the name of the recording. `command` must outlive `sub`.
void add_live_options(CLI::App& sub, LiveCommand& command);

/// The exit code; what went wrong is on stderr.
int run_live(LiveCommand& command);

}  // namespace lsv::cli
