// SPDX-License-Identifier: BSD-3-Clause
// The runs of `lsv calibrate scale`, read from a table that people write: one row per run,
//   track,travel_x_m,travel_y_m,sigma_m      end to end: the travel was measured
//   track,truth,sigma_m                      a file with the columns time_s,x_m,y_m instead
// `track` is a track.csv of `lsv track`; names are relative to the folder of the table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/scale_fit.h"
#include "lsv/core/result.h"

namespace lsv::cli {

struct ScaleRuns {
  std::vector<ScaleRun> runs;
  std::vector<std::string> warnings;  // about refused shifts
  std::string inputs_sha256;          // of the table, the tracks and the truths, in that order
};

/// `sigma_ratio` stands for the column sigma_m: the sigma of the reference per travel.
Result<ScaleRuns> read_scale_runs(const std::string& path, std::optional<double> sigma_ratio);

}  // namespace lsv::cli
