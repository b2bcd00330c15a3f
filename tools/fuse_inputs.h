// SPDX-License-Identifier: BSD-3-Clause
// The files that `lsv fuse` reads, as samples in the order of their times. Columns are found by
// name (docs/formats.md); rows without figures, or with a status that is not `ok`, are counted and
// left out. Times of all files are of one clock: each overlaps with another one.
#pragma once

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "fusion/rover_config.h"
#include "fusion/samples.h"
#include "lsv/core/result.h"

namespace lsv::cli {

struct FuseInputs {
  std::vector<std::string> lsv;
  std::string wheels;  // empty: none
  std::string imu;
};

struct FuseSample {
  Stamp when{};  // that the sample counts for
  std::size_t sensor = 0;
  std::variant<LsvSample, WheelSample, GyroSample, StandstillSample> what;
};

struct FuseSamples {
  std::vector<FuseSample> samples;  // by time; of one time LSV, wheels, IMU
  std::size_t rows_read = 0;
  std::size_t rows_left_out = 0;
};

/// bad_input, naming file, line and column.
Result<FuseSamples> read_samples(const FuseInputs& inputs, const FusionConfig& config);

}  // namespace lsv::cli
