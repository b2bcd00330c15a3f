// SPDX-License-Identifier: BSD-3-Clause
// lsv record: a camera to a recording that replays by itself (docs/recording.md).
#include <memory>

#include "tools/commands.h"
#include "tools/live_run.h"

namespace lsv::cli {

void add_record_command(CLI::App& app, int& exit_code) {
  auto command = std::make_shared<LiveCommand>();
  CLI::App* const sub =
      app.add_subcommand("record", "Record a camera, and what is measured of it, to one file");
  add_live_options(*sub, *command);
  sub->add_option("RECORDING", command->recording, "New file, .mcap")->required();
  sub->footer(
      "Example:\n"
      "  lsv simulate camera --seconds 60 &\n"
      "  # go on when it says that the camera is ready, after some seconds\n"
      "  lsv record genicam:127.0.0.1 drive.mcap --calibration sample_frames/calibration.toml \\\n"
      "      --seconds 30\n"
      "  lsv replay drive.mcap -o out\n"
      "Exit codes: 0 ok, 1 output not written, 2 usage, 3 camera, 4 too many shifts refused, "
      "130 interrupted.");
  sub->callback([command, sub, &exit_code] {
    const Result<void> named = refuse_empty_names(*sub);
    exit_code = named ? run_live(*command) : report_error(named.error());
  });
}

}  // namespace lsv::cli
