// SPDX-License-Identifier: BSD-3-Clause
// What tells gross outliers from noise: the median of absolute residuals, which they hardly move.
// Pure functions of their arguments.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace lsv {

/// `share` in [0, 1] of the values lie below; of at least one value.
inline double quantile(std::vector<double> values, double share) {
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::lround(share * last));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

/// The standard deviation of a normal distribution with this median of absolute values.
inline double sigma_of_median(double median_of_absolutes) { return 1.4826 * median_of_absolutes; }

/// The standard deviation of a normal distribution of which nine tenths lie within these absolute
/// values: for residuals of which a tenth may be gross.
inline double sigma_of_nine_tenths(std::vector<double> absolutes) {
  return quantile(std::move(absolutes), 0.9) / 1.6449;
}

/// Beyond it a residual in sigmas is an outlier. `absolutes`: of all residuals, in sigmas. Sigmas
/// that are stated too small do not make outliers of everything.
inline double outlier_limit_sigmas(std::vector<double> absolutes) {
  constexpr double kOutlier_sigmas = 6.0;
  if (absolutes.empty()) return kOutlier_sigmas;
  return kOutlier_sigmas * std::max(1.0, sigma_of_median(median(std::move(absolutes))));
}

/// From the 2nd to the 98th percentile, of at least one value.
inline double spread(const std::vector<double>& values) {
  return quantile(values, 0.98) - quantile(values, 0.02);
}

}  // namespace lsv
