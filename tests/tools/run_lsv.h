// SPDX-License-Identifier: BSD-3-Clause
// Runs the program `lsv` that is built with the tests (LSV_PROGRAM), and what is asked of it again
// and again.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/run_program.h"

namespace lsv::test {

using Args = std::vector<std::string>;

inline Args with(Args args, const Args& more) {
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

inline ProgramResult lsv_run(const Args& args, const std::string& input = "",
                             const std::vector<std::string>& environment = {}) {
  return run_program(with({LSV_PROGRAM}, args), input, environment);
}

inline void expect_one_line_error(const ProgramResult& result, int exit_code,
                                  const std::string& says) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.err.rfind("lsv: ", 0), 0U) << result.err;
  EXPECT_NE(result.err.find(says), std::string::npos) << says << " in " << result.err;
  EXPECT_EQ(result.out, "");
}

}  // namespace lsv::test
