// SPDX-License-Identifier: BSD-3-Clause
// Options that are numbers in the unit that people use, checked and turned into SI units.
#pragma once

#include <CLI/CLI.hpp>

#include "lsv/core/result.h"

namespace lsv::cli {

/// Where the value goes in SI units, and what it may be as typed. The ranges are wide; they are
/// there to catch a value in the wrong unit.
struct NumberOption {
  const char* name;
  double typed;
  double si_per_typed;
  double least;
  double most;
  double* si;
};

/// Leaves the target alone when the option was not given; invalid_argument out of range, which NaN
/// is.
Result<void> take(const CLI::App& command, const NumberOption& number);

}  // namespace lsv::cli
