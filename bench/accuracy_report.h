// SPDX-License-Identifier: BSD-3-Clause
// The accuracy report: a page of tables and its plots. The same results give the same bytes.
#pragma once

#include <string>

#include "bench/accuracy_results.h"

namespace lsv::bench {

/// Writes `folder`/accuracy.md and `folder`/accuracy/*.svg. Throws std::runtime_error when a file
/// cannot be written.
void write_report(const std::string& folder, const AccuracyResults& results);

}  // namespace lsv::bench
