// SPDX-License-Identifier: BSD-3-Clause
// The measurements of the accuracy report, each in a file of its own. Progress goes to stderr.
// Throws std::runtime_error when something cannot be simulated or set up.
#pragma once

#include "bench/accuracy_results.h"

namespace lsv::bench {

enum class Peers { without, with };

/// accuracy_cases.cpp: every condition at every size.
std::vector<CaseResult> measure_cases(int pairs, Peers peers);

/// accuracy_s_curve.cpp: condition B, shifts of 0 to 1 px along x.
std::vector<SCurve> measure_s_curves(int pairs_per_point);

/// A drive along x at constant speed, in the noise of condition B.
struct Drive {
  double speckle_px = 0.0;
  double speed_px_per_frame = 0.0;
};
/// accuracy_drift.cpp.
std::vector<DriftResult> measure_drifts(const std::vector<Drive>& drives, int frames);
ParkedResult measure_parked(int frames);

}  // namespace lsv::bench
