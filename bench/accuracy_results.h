// SPDX-License-Identifier: BSD-3-Clause
// What a run has measured.
#pragma once

#include <string_view>
#include <vector>

#include "bench/accuracy_conditions.h"
#include "bench/accuracy_errors.h"

namespace lsv::bench {

struct MethodErrors {
  std::string_view method;
  Errors errors;
};

/// One condition at one speckle size, every method on the same pairs.
struct CaseResult {
  const Condition* condition = nullptr;
  int size = 0;           // into kSpeckleSizes_px
  double bound_px = 0.0;  // root of the mean Cramer-Rao bound over pairs and axes
  std::vector<MethodErrors> methods{};

  const Errors* errors_of(std::string_view method) const {
    for (const MethodErrors& entry : methods)
      if (entry.method == method) return &entry.errors;
    return nullptr;
  }
};

/// Mean error along x against the fraction of a pixel moved along x.
struct SCurve {
  int size = 0;
  std::string_view method;
  std::vector<double> shift_px{};
  std::vector<double> bias_px{};
  std::vector<double> standard_error_px{};
};

struct DriftResult {
  double speckle_px = 0.0;
  double speed_px_per_frame = 0.0;
  int frames = 0;
  /// Distance measured / distance travelled - 1.
  double precise_error_ratio = kUnknown;
  double classic_error_ratio = kUnknown;
  int precise_refused = 0;
  int classic_refused = 0;
};

struct ParkedResult {
  int frames = 0;
  double farthest_px = 0.0;  // from the position of the first frame
  int frames_moving = 0;     // reported as `moving`
  int refused = 0;
};

struct AccuracyResults {
  int pairs = 0;  // per condition and size
  std::vector<CaseResult> cases;
  int s_curve_pairs = 0;  // per point
  std::vector<SCurve> s_curves;
  std::vector<DriftResult> drifts;
  ParkedResult parked;

  const CaseResult* find(std::string_view condition, int size) const {
    for (const CaseResult& result : cases)
      if (result.condition->name == condition && result.size == size) return &result;
    return nullptr;
  }
};

}  // namespace lsv::bench
