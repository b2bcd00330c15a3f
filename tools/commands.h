// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of the program, one file each (cmd_<name>.cpp), and what they share: exit codes
// and how an error becomes one line on stderr.
#pragma once

#include <CLI/CLI.hpp>

#include "lsv/core/result.h"

namespace lsv::cli {

// docs/cli.md lists these for users.
inline constexpr int kExitOk = 0;
inline constexpr int kExitOutputFailed = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitBadInput = 3;
inline constexpr int kExitLowQuality = 4;
inline constexpr int kExitInterrupted = 130;

/// Prints "lsv: <message>" to stderr and returns the exit code of the error.
int report_error(const Error& error);

/// Each adds one subcommand whose callback stores its exit code in `exit_code`, which outlives
/// the parse.
void add_budget_command(CLI::App& app, int& exit_code);
void add_calibrate_command(CLI::App& app, int& exit_code);
void add_convert_command(CLI::App& app, int& exit_code);
void add_evaluate_command(CLI::App& app, int& exit_code);
void add_faults_command(CLI::App& app, int& exit_code);
void add_fuse_command(CLI::App& app, int& exit_code);
void add_info_command(CLI::App& app, int& exit_code);
void add_live_command(CLI::App& app, int& exit_code);
void add_record_command(CLI::App& app, int& exit_code);
void add_recover_command(CLI::App& app, int& exit_code);
void add_replay_command(CLI::App& app, int& exit_code);
void add_shift_command(CLI::App& app, int& exit_code);
void add_simulate_command(CLI::App& app, int& exit_code);
void add_track_command(CLI::App& app, int& exit_code);

/// Below `lsv calibrate`.
void add_calibrate_camera(CLI::App& calibrate, int& exit_code);
void add_calibrate_geometry(CLI::App& calibrate, int& exit_code);
void add_calibrate_mount(CLI::App& calibrate, int& exit_code);
void add_calibrate_noise(CLI::App& calibrate, int& exit_code);
void add_calibrate_scale(CLI::App& calibrate, int& exit_code);

/// Below `lsv simulate`.
void add_simulate_camera(CLI::App& simulate, int& exit_code);
void add_simulate_flat(CLI::App& simulate, int& exit_code);
void add_simulate_rover(CLI::App& simulate, int& exit_code);
void add_simulate_speckle(CLI::App& simulate, int& exit_code);
void add_simulate_tracks(CLI::App& simulate, int& exit_code);

}  // namespace lsv::cli
