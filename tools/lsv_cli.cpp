// SPDX-License-Identifier: BSD-3-Clause
// The program `lsv`: parses the command line and hands over to one subcommand.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <opencv2/core/utils/logger.hpp>
#include <string>

#include "tools/commands.h"

namespace lsv::cli {

namespace {

/// CLI11 says only that a command is missing when one is misspelt; this names it.
Result<void> check_command_words(const CLI::App& app, int argc, char** argv) {
  const CLI::App* level = &app;
  for (int i = 1; i < argc && argv[i][0] != '-' && level->get_require_subcommand_min() > 0; ++i) {
    const auto commands = level->get_subcommands([](const CLI::App*) { return true; });
    const auto known = std::find_if(commands.begin(), commands.end(),
                                    [&](const CLI::App* c) { return c->get_name() == argv[i]; });
    if (known == commands.end()) {
      return Error{ErrorCode::invalid_argument,
                   "'" + std::string(argv[i]) + "' is not a command; lsv --help lists them"};
    }
    level = *known;
  }
  return {};
}

int run(int argc, char** argv) {
  CLI::App app{"lsv: laser speckle velocimetry - camera frames in, calibrated track out"};
  app.set_version_flag("--version", "lsv " LSV_VERSION);
  app.require_subcommand(1);
  int exit_code = kExitOk;
  add_track_command(app, exit_code);
  add_live_command(app, exit_code);
  add_fuse_command(app, exit_code);
  add_info_command(app, exit_code);
  add_shift_command(app, exit_code);
  add_record_command(app, exit_code);
  add_replay_command(app, exit_code);
  add_recover_command(app, exit_code);
  add_convert_command(app, exit_code);
  add_simulate_command(app, exit_code);
  add_calibrate_command(app, exit_code);
  add_evaluate_command(app, exit_code);
  add_budget_command(app, exit_code);
  add_faults_command(app, exit_code);
  if (const Result<void> words = check_command_words(app, argc, argv); !words)
    return report_error(words.error());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    // CLI11's own codes (109 for an unknown word) mean nothing to users.
    return report_error({ErrorCode::invalid_argument,
                         std::string(error.what()) + "; see lsv --help or lsv COMMAND --help"});
  }
  return exit_code;
}

}  // namespace
}  // namespace lsv::cli

int main(int argc, char** argv) {
  // Video libraries talk on stderr by default; our one line per error is the only voice there.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  try {
    return lsv::cli::run(argc, argv);
  } catch (const std::exception& error) {  // out of memory, above all
    return lsv::cli::report_error(
        {lsv::ErrorCode::output_failed, std::string("stopped by: ") + error.what()});
  }
}
