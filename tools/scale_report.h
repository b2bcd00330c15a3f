// SPDX-License-Identifier: BSD-3-Clause
// What `lsv calibrate scale` says about a fit: a table for the terminal and a page with residual
// plots that needs no network.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/scale_fit.h"

namespace lsv::cli {

struct ScaleReport {
  Calibration calibration;  // the new one
  ScaleFit fit;
  std::vector<ScaleRun> runs;
  std::optional<ScaleChange> change;  // against the calibration given
  std::vector<std::string> warnings;
};

std::string scale_text(const ScaleReport& report);
std::string scale_html(const ScaleReport& report);

}  // namespace lsv::cli
