// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <string>

#include "tools/commands.h"

namespace lsv::cli {

int report_error(const Error& error) {
  std::string line = error.message;  // file names may hold anything; the error stays one line
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  std::fprintf(stderr, "lsv: %s\n", line.c_str());
  switch (error.code) {
    case ErrorCode::invalid_argument:
      return kExitUsage;
    case ErrorCode::bad_input:
    case ErrorCode::unsupported:
      return kExitBadInput;
    case ErrorCode::output_failed:
      return kExitOutputFailed;
  }
  return kExitOutputFailed;
}

}  // namespace lsv::cli
