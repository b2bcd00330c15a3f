// SPDX-License-Identifier: BSD-3-Clause
// Runs a program as a user would and tells what came of it: exit code, both streams, time, memory.
#pragma once

#include <string>
#include <vector>

namespace lsv::test {

struct ProgramResult {
  int exit_code = -1;  // 128 + signal when it was killed
  std::string out;
  std::string err;
  double wall_s = 0.0;
  double peak_rss_mib = 0.0;
};

/// `args[0]` is the program. `input` goes to its standard input. `environment` holds NAME=VALUE
/// entries that are added to the present one.
ProgramResult run_program(const std::vector<std::string>& args, const std::string& input = "",
                          const std::vector<std::string>& environment = {});

/// A fresh directory for the running test, different for every test and process.
std::string fresh_directory();

std::string read_text(const std::string& path);
void write_text(const std::string& path, const std::string& text);

}  // namespace lsv::test
