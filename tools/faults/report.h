// SPDX-License-Identifier: BSD-3-Clause
// The campaign as a table of docs/reliability.md.
#pragma once

#include <string>
#include <vector>

#include "tools/faults/campaign.h"

namespace lsv::faults {

/// Markdown, one row per scenario, and below it each limit that is broken.
std::string table(const std::vector<Row>& rows);

}  // namespace lsv::faults
