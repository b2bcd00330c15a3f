// SPDX-License-Identifier: BSD-3-Clause
// The result of `lsv budget` for people and for programs.
#pragma once

#include <string>

#include "tools/budget_measure.h"

namespace lsv::cli {

struct Budget {
  std::string cpu_model;
  std::string simd_target;
  std::string fft_backend;
  double rate_hz = 0.0;
  FrameFormat format;
  Preset preset = Preset::precise;
  double max_step_px = 0.0;  // of the simulated motion, per frame and axis
  CorrelationConfig correlation;
  LagRange lags;
  UnpacedTimes unpaced;
  PacedTimes paced;
};

std::string budget_text(const Budget& budget);

/// One JSON object, schema "lsv.budget/1".
std::string budget_json(const Budget& budget);

}  // namespace lsv::cli
