// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate`: the parent of the commands that make frames and tracks of which everything is
// known.
#include "tools/commands.h"

namespace lsv::cli {

void add_simulate_command(CLI::App& app, int& exit_code) {
  CLI::App* const simulate =
      app.add_subcommand("simulate", "Make frames and tracks of which all is known");
  simulate->require_subcommand(1);
  add_simulate_speckle(*simulate, exit_code);
  add_simulate_tracks(*simulate, exit_code);
  add_simulate_rover(*simulate, exit_code);
  add_simulate_flat(*simulate, exit_code);
  add_simulate_camera(*simulate, exit_code);
}

}  // namespace lsv::cli
