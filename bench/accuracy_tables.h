// SPDX-License-Identifier: BSD-3-Clause
// The tables of the accuracy report, as Markdown.
#pragma once

#include <string>
#include <string_view>

#include "bench/accuracy_results.h"

namespace lsv::bench {

std::string conditions_table();
/// RMSE of every method at one speckle size, a row for each condition.
std::string rmse_table(const AccuracyResults& results, int size);
/// Everything about one method, a row for each condition and size, with Must and Aim.
std::string method_table(const AccuracyResults& results, std::string_view method);
/// Largest bias over the sub-pixel shift.
std::string s_curve_table(const AccuracyResults& results);
std::string drift_table(const AccuracyResults& results);

}  // namespace lsv::bench
