// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate`: the parent of the commands that find what a calibration holds, and what to
// expect of it.
#include "tools/commands.h"

namespace lsv::cli {

void add_calibrate_command(CLI::App& app, int& exit_code) {
  CLI::App* const calibrate = app.add_subcommand(
      "calibrate", "Find scale, camera and mount of a sensor, and what noise to expect");
  calibrate->require_subcommand(1);
  add_calibrate_camera(*calibrate, exit_code);
  add_calibrate_geometry(*calibrate, exit_code);
  add_calibrate_mount(*calibrate, exit_code);
  add_calibrate_noise(*calibrate, exit_code);
  add_calibrate_scale(*calibrate, exit_code);
}

}  // namespace lsv::cli
