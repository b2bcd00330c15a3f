// SPDX-License-Identifier: BSD-3-Clause
#include "tools/output_names.h"

#include <algorithm>
#include <filesystem>
#include <set>

namespace lsv::cli {

namespace fs = std::filesystem;

Result<void> refuse_empty_names(const CLI::App& command,
                                std::initializer_list<const char*> options) {
  for (const char* const option : options) {
    const CLI::Option* const given = command.get_option(option);
    if (given->count() > 0 && given->as<std::string>().empty())
      return Error{ErrorCode::invalid_argument, std::string(option) + ": the name is empty"};
  }
  return {};
}

Result<void> at_most_one_on_stdout(const std::vector<std::string>& outputs) {
  if (std::count(outputs.begin(), outputs.end(), "-") > 1) {
    return Error{ErrorCode::invalid_argument,
                 "only one output can be '-' (standard output) at a time"};
  }
  return {};
}

Result<void> refuse_stdout(const std::string& output, const std::string& what) {
  if (output != "-") return {};
  return Error{ErrorCode::invalid_argument,
               what + " cannot go to standard output ('-'): name a file"};
}

Result<void> refuse_shared_files(const std::vector<std::string>& outputs) {
  std::set<fs::path> taken;
  for (const std::string& output : outputs) {
    std::error_code ignored;
    if (output.empty() || output == "-" || fs::is_other(output, ignored)) continue;
    const fs::path absolute = fs::absolute(output, ignored);
    const fs::path file = fs::weakly_canonical(absolute, ignored);
    if (!taken.insert(file.empty() ? absolute : file).second) {
      return Error{ErrorCode::invalid_argument,
                   output + ": is named for two outputs; give every output its own name"};
    }
  }
  return {};
}

Result<void> refuse_inputs(const std::vector<std::string>& outputs,
                           const std::vector<std::string>& inputs) {
  for (const std::string& output : outputs) {
    std::error_code ignored;  // what does not exist is not an input
    if (output.empty() || !fs::is_regular_file(output, ignored)) continue;
    for (const std::string& input : inputs) {
      if (fs::equivalent(output, input, ignored)) {
        return Error{ErrorCode::invalid_argument,
                     output + ": is an input of this run; choose another name for the output"};
      }
    }
  }
  return {};
}

}  // namespace lsv::cli
