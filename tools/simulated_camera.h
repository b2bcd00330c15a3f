// SPDX-License-Identifier: BSD-3-Clause
// The options of `lsv simulate` that describe the camera, the same for speckle and for flat light,
// so that both see one sensor.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "lsv/core/result.h"
#include "sim/speckle.h"

namespace lsv::cli {

struct SimulatedCamera {
  std::string size = "128x128";
  double mean_counts = 0.0;
  double full_well_electrons = 0.0;
  double prnu_percent = 0.0;
  std::uint64_t sensor_seed = 0;
  sim::SpeckleConfig config;
};

/// `camera` must outlive the command.
void add_camera_options(CLI::App& command, SimulatedCamera& camera);
/// Those of the light, besides: speckle size, exposure, mean signal.
void add_speckle_options(CLI::App& command, SimulatedCamera& camera);

/// What was given on the command line into `camera.config`; sim::validate() checks the ranges.
Result<void> resolve_camera(const CLI::App& command, SimulatedCamera& camera);

/// The command as it can be typed again, without the directory of the program; `parent` is what
/// comes before its name.
std::string command_line(const CLI::App& command, const std::string& parent = "lsv simulate ");

}  // namespace lsv::cli
