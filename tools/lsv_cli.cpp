// SPDX-License-Identifier: BSD-3-Clause
// The program `lsv`.
#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>

#include "tools/command_line.h"

namespace {

/// In the order of the help.
constexpr lsv::cli::AddCommand kCommands[] = {
    lsv::cli::add_track_command,    lsv::cli::add_live_command,      lsv::cli::add_fuse_command,
    lsv::cli::add_info_command,     lsv::cli::add_shift_command,     lsv::cli::add_record_command,
    lsv::cli::add_replay_command,   lsv::cli::add_recover_command,   lsv::cli::add_convert_command,
    lsv::cli::add_simulate_command, lsv::cli::add_calibrate_command, lsv::cli::add_evaluate_command,
    lsv::cli::add_budget_command,   lsv::cli::add_faults_command};

}  // namespace

int main(int argc, char** argv) {
  // Video libraries talk on stderr by default; our one line per error is the only voice there.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  return lsv::cli::run_command_line(argc, argv, kCommands);
}
