// SPDX-License-Identifier: BSD-3-Clause
// Reads whole files into memory, with a bound: the small texts that people write by hand
// (calibrations, settings) and the maps of a sensor.
#pragma once

#include <cstdint>
#include <string>

#include "lsv/core/result.h"

namespace lsv {

/// The whole file. bad_input, naming the file, when it is not a regular file, cannot be read or
/// is larger than 1 MiB. `kind` says what it should be: "calibration".
Result<std::string> read_text_file(const std::string& path, const std::string& kind);

/// The same for any bytes and any bound.
Result<std::string> read_whole_file(const std::string& path, const std::string& kind,
                                    std::uintmax_t max_bytes);

}  // namespace lsv
