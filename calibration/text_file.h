// SPDX-License-Identifier: BSD-3-Clause
// Reads the small text files that people write by hand: calibrations and settings.
#pragma once

#include <string>

#include "lsv/core/result.h"

namespace lsv {

/// The whole file. bad_input, naming the file, when it is not a regular file, cannot be read or
/// is larger than 1 MiB. `kind` says what it should be: "calibration".
Result<std::string> read_text_file(const std::string& path, const std::string& kind);

}  // namespace lsv
