// SPDX-License-Identifier: BSD-3-Clause
// The books of a stream as JSON, schema lsv.health/1: every counter under its own name, durations
// in s, null where unknown.
#pragma once

#include <string>

#include "lsv/core/health_snapshot.h"

namespace lsv::cli {

std::string health_json(const HealthSnapshot& health);

}  // namespace lsv::cli
