// SPDX-License-Identifier: BSD-3-Clause
// The results of `precise` as a plain table, for a terminal.
#pragma once

#include <cstdio>

#include "bench/accuracy_results.h"

namespace lsv::bench {

void print_table(std::FILE* out, const AccuracyResults& results);

}  // namespace lsv::bench
