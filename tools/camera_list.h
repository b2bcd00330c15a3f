// SPDX-License-Identifier: BSD-3-Clause
// `lsv info genicam:`: which cameras answer.
#pragma once

#include "lsv/core/result.h"

namespace lsv::cli {

/// On standard output, one line each, or as JSON (schema lsv.cameras/1).
Result<void> print_cameras(bool json);

}  // namespace lsv::cli
