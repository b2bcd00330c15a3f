// SPDX-License-Identifier: BSD-3-Clause
#include "tools/output_names.h"

#include <algorithm>
#include <filesystem>

namespace lsv::cli {

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

Result<void> refuse_inputs(const std::vector<std::string>& outputs,
                           const std::vector<std::string>& inputs) {
  for (const std::string& output : outputs) {
    std::error_code ignored;  // what does not exist is not an input
    if (output.empty() || !std::filesystem::is_regular_file(output, ignored)) continue;
    for (const std::string& input : inputs) {
      if (std::filesystem::equivalent(output, input, ignored)) {
        return Error{ErrorCode::invalid_argument,
                     output + ": is an input of this run; choose another name for the output"};
      }
    }
  }
  return {};
}

}  // namespace lsv::cli
