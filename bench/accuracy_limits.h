// SPDX-License-Identifier: BSD-3-Clause
// What lsv promises (Must) and what it strives for (Aim).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy_results.h"

namespace lsv::bench {

inline constexpr double kMustDriftRatio = 1e-4;
inline constexpr double kMustParked_px = 0.005;
inline constexpr double kMustWithin1 = 0.68;
inline constexpr double kMustWithin1Margin = 0.05;
inline constexpr double kMustWithin196 = 0.95;
inline constexpr double kMustWithin196Margin = 0.03;

/// Root of the mean square error per axis, mpx. Unset: no limit.
std::optional<double> must_rmse_mpx(std::string_view method, std::string_view condition, int size);
std::optional<double> aim_rmse_mpx(const AccuracyResults& results, std::string_view method,
                                   const CaseResult& of);
/// Of `precise`.
bool must_have_no_outliers(std::string_view condition);

/// How many standard deviations of chance are granted to RMSE and coverage: with few pairs the
/// figure itself is uncertain.
enum class Allowance { none, three_sigmas };

/// One sentence for each Must that is broken.
std::vector<std::string> broken_limits(const AccuracyResults& results, Allowance allowance);
/// Of one case only.
std::vector<std::string> broken_limits(const CaseResult& result, Allowance allowance);

}  // namespace lsv::bench
