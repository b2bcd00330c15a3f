// SPDX-License-Identifier: BSD-3-Clause
// The pictures of the accuracy report, each in a file of its own, as SVG text.
#pragma once

#include <string>

#include "bench/accuracy_results.h"

namespace lsv::bench {

/// accuracy_plot_rmse.cpp: bars per condition and method.
std::string plot_rmse(const AccuracyResults& results);
/// accuracy_plot_s_curve.cpp: bias against sub-pixel shift.
std::string plot_s_curves(const AccuracyResults& results);
/// accuracy_plot_coverage.cpp: share of the errors within 1 and 1.96 sigma.
std::string plot_coverage(const AccuracyResults& results);
/// accuracy_plot_drift.cpp: error of the distance after a long drive.
std::string plot_drift(const AccuracyResults& results);

}  // namespace lsv::bench
