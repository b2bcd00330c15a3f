// SPDX-License-Identifier: BSD-3-Clause
#include "tools/command_line.h"

#include <algorithm>
#include <exception>
#include <string>

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

int run(int argc, char** argv, std::span<const AddCommand> commands) {
  CLI::App app{"lsv: laser speckle velocimetry - camera frames in, calibrated track out"};
  app.set_version_flag("--version", "lsv " LSV_VERSION);
  app.require_subcommand(1);
  int exit_code = kExitOk;
  for (const AddCommand add : commands) add(app, exit_code);
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

int run_command_line(int argc, char** argv, std::span<const AddCommand> commands) {
  try {
    return run(argc, argv, commands);
  } catch (const std::exception& error) {  // out of memory, above all
    return report_error({ErrorCode::output_failed, std::string("stopped by: ") + error.what()});
  }
}

}  // namespace lsv::cli
