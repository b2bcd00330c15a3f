// SPDX-License-Identifier: BSD-3-Clause
// What `lsv calibrate noise` says: the prediction of calibration/noise_model.h for one set-up, how
// it depends on each figure alone, and the choice of window, rate and exposure; as text, as JSON
// and as a page that needs no network. Lengths of the text are in mpx = 0.001 px.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calibration/noise_choice.h"
#include "calibration/noise_model.h"
#include "lsv/core/calibration.h"

namespace lsv::cli {

struct NoiseInput {
  Calibration calibration;
  /// Shift and blur follow from the speed.
  NoiseConditions conditions;
  double rate_hz = kUnknown;
  double exposure_s = kUnknown;
  double speed_m_s = kUnknown;  // along image x
  double update_hz = kUnknown;
  std::vector<int> windows_px;
  std::vector<CameraRate> camera_rates;
  double push_s = kUnknown;  // at the size of the conditions
};

/// One figure changed, all others as given.
struct NoiseSweep {
  std::string_view key;   // for programs
  std::string_view name;  // for people
  bool is_logarithmic = false;
  double given = kUnknown;
  struct At {
    double value = kUnknown;
    double sigma_x_px = kUnknown;  // NaN out of range
    double sigma_y_px = kUnknown;
  };
  std::vector<At> table;
  std::vector<At> curve;
};

struct NoiseReport {
  NoiseInput input;  // shift and blur filled in
  SensorScale scale_x;
  SensorScale scale_y;
  NoisePrediction pair;
  TrackingNoise tracking;
  std::vector<NoiseSweep> sweeps;
  ChoiceQuestion question;
  Recommendation recommendation;
  /// What happens to the best choice when one thing about it is changed, a line each.
  std::vector<std::string> reasons;
  std::vector<std::string> warnings;
};

NoiseReport noise_report(const NoiseInput& input);

std::string noise_text(const NoiseReport& report);
/// Schema "lsv.noise/1".
std::string noise_json(const NoiseReport& report);
std::string noise_html(const NoiseReport& report);

}  // namespace lsv::cli
