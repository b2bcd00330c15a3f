// SPDX-License-Identifier: BSD-3-Clause
// Drives of a simulated rover as TOML, by name (they are part of the program) or from a file. Keys:
// docs/formats.md.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lsv/core/result.h"
#include "sim/rover_drive.h"
#include "sim/rover_sensors.h"

namespace lsv::cli {

struct ScenarioSensor {
  std::string name;
  sim::RoverLsvConfig config;
};

struct ScenarioImu {
  sim::ImuConfig config;
  double bias_sigma_rad_s = 0.0;
};

/// How fast the speeds of the rover change, for the filter alone.
struct ScenarioMotion {
  double vx_walk_m_s = 0.0;
  double wz_walk_rad_s = 0.0;
};

struct RoverScenario {
  std::string text;  // as read
  sim::RoverPlan plan;
  sim::EncoderConfig encoders;
  std::vector<ScenarioSensor> lsv;
  std::optional<ScenarioImu> imu;
  std::optional<ScenarioMotion> motion;
};

struct ScenarioName {
  std::string_view name;
  std::string_view sentence;
};
/// Those of the program.
std::vector<ScenarioName> scenario_names();

/// invalid_argument when it is neither a name nor a file; bad_input, naming file, line and key.
Result<RoverScenario> load_scenario(const std::string& name_or_path);

/// `file` stands for the file in messages.
Result<RoverScenario> parse_scenario(const std::string& text, const std::string& file);

/// What `lsv fuse` must know of the rover of a scenario.
std::string rover_toml(const RoverScenario& scenario);

}  // namespace lsv::cli
