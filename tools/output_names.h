// SPDX-License-Identifier: BSD-3-Clause
// What must hold for the names of a command's outputs before any of them is opened. An empty name
// is an output that nobody asked for; "-" is standard output.
#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <string>
#include <vector>

#include "lsv/core/result.h"

namespace lsv::cli {

/// An option of `command` that was given an empty name, as by an unset shell variable, is an error.
Result<void> refuse_empty_names(const CLI::App& command,
                                std::initializer_list<const char*> options);

Result<void> at_most_one_on_stdout(const std::vector<std::string>& outputs);

/// Refuses '-' for an output that can only be a file; `what` names it.
Result<void> refuse_stdout(const std::string& output, const std::string& what);

/// Refuses a file that is, by whatever name, more than one of the outputs.
Result<void> refuse_shared_files(const std::vector<std::string>& outputs);

/// Refuses an output that is, by whatever name, one of the files read.
Result<void> refuse_inputs(const std::vector<std::string>& outputs,
                           const std::vector<std::string>& inputs);

}  // namespace lsv::cli
