// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate rover`, `lsv fuse` and `lsv evaluate` alone. The whole program is linked to what
// reads videos, which takes 0.1 s to load; a test that starts it a hundred times waits for that.
#include "tools/command_line.h"

namespace {

void add_simulate(CLI::App& app, int& exit_code) {
  CLI::App* const simulate = app.add_subcommand("simulate");
  simulate->require_subcommand(1);
  lsv::cli::add_simulate_rover(*simulate, exit_code);
}

constexpr lsv::cli::AddCommand kCommands[] = {add_simulate, lsv::cli::add_fuse_command,
                                              lsv::cli::add_evaluate_command};

}  // namespace

int main(int argc, char** argv) { return lsv::cli::run_command_line(argc, argv, kCommands); }
