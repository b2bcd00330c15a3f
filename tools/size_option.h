// SPDX-License-Identifier: BSD-3-Clause
// The text of --size.
#pragma once

#include <string>

#include "lsv/core/result.h"
#include "sim/speckle.h"

namespace lsv::cli {

/// "WIDTHxHEIGHT" into the frame size of `camera`; the range is checked by sim::validate().
Result<void> parse_size(const std::string& text, sim::SpeckleConfig& camera);

}  // namespace lsv::cli
