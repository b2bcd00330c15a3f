// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate`: the parent of the commands that tell how far the surface moved for a px, and how
// well that is known.
#include "tools/commands.h"

namespace lsv::cli {

void add_calibrate_command(CLI::App& app, int& exit_code) {
  CLI::App* const calibrate = app.add_subcommand(
      "calibrate", "Find the scale, from px of the pattern to metres, and the noise");
  calibrate->require_subcommand(1);
  add_calibrate_geometry(*calibrate, exit_code);
  add_calibrate_noise(*calibrate, exit_code);
  add_calibrate_scale(*calibrate, exit_code);
}

}  // namespace lsv::cli
