// SPDX-License-Identifier: BSD-3-Clause
// A program of subcommands: parses the command line and hands over to one of them.
#pragma once

#include <span>

#include "tools/commands.h"

namespace lsv::cli {

/// Adds one subcommand, as those of commands.h.
using AddCommand = void (*)(CLI::App& app, int& exit_code);

/// The exit code for main(). Prints help, the version, or one line about what went wrong.
int run_command_line(int argc, char** argv, std::span<const AddCommand> commands);

}  // namespace lsv::cli
