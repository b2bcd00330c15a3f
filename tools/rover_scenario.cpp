// SPDX-License-Identifier: BSD-3-Clause
#include "tools/rover_scenario.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "calibration/text_file.h"
#include "lsv/core/shift.h"
#include "lsv/output/number_text.h"
#include "tools/rover_scenarios/rover_scenarios.h"
#include "tools/toml_section.h"

namespace lsv::cli {
namespace {

using Failure = std::optional<Error>;

constexpr const char* kSchema = "lsv.scenario/1";
constexpr std::array kSections = {"schema", "drive",  "command", "patch", "side_slip",
                                  "random", "wheels", "lsv",     "imu",   "motion"};
constexpr int kMostSteps = 10'000'000;
/// Of readings that nobody makes noisy: the filter needs some.
constexpr double kLeastNoise_rad_s = 1e-3;

struct Named {
  const char* name;
  const std::string_view* text;
};
constexpr Named kScenarios[] = {
    {"appendix_d", &scenarios::appendix_d},       {"hard_ground", &scenarios::hard_ground},
    {"sand_crossing", &scenarios::sand_crossing}, {"outliers", &scenarios::outliers},
    {"velocity_step", &scenarios::velocity_step}, {"side_slip", &scenarios::side_slip},
    {"lsv_lost", &scenarios::lsv_lost},           {"noisy_encoders", &scenarios::noisy_encoders},
    {"random_drive", &scenarios::random_drive},   {"square_sand", &scenarios::square_sand}};

/// The first line, which is a comment.
std::string_view sentence_of(std::string_view text) {
  text.remove_prefix(std::min(text.size(), text.find_first_not_of("# \n")));
  return text.substr(0, text.find('\n'));
}

void check(TomlSection& in, const char* key, double value, double least, double most) {
  if (value >= least && value <= most) return;
  in.fail(key, formatted("must be between %g and %g", least, most));
}

Failure read_drive(const std::string& file, const toml::table* table, RoverScenario& out) {
  sim::RoverPlan& plan = out.plan;
  TomlSection in(file, table, "drive");
  std::string integrator = "exact";
  in.optional("integrator", integrator);
  if (integrator == "euler")
    plan.integrator = sim::RoverIntegrator::euler;
  else if (integrator != "exact")
    in.fail("integrator", "must be \"exact\" or \"euler\"");
  in.required("step_s", plan.step_s);
  in.optional_whole("steps", plan.steps);
  in.optional("x_m", plan.start_x_m);
  in.optional("y_m", plan.start_y_m);
  in.optional("yaw_rad", plan.start_yaw_rad);
  in.optional("ramp_s", plan.ramp_s);
  check(in, "step_s", plan.step_s, 1e-5, 1e3);
  check(in, "steps", plan.steps, 1, kMostSteps);
  check(in, "ramp_s", plan.ramp_s, 0.0, 1e6);
  return in.finish();
}

Failure read_command(const std::string& file, const toml::table& table, RoverScenario& out) {
  sim::WheelCommand command;
  TomlSection in(file, &table, "command");
  in.required("duration_s", command.duration_s);
  in.required("left_rad_s", command.left_rad_s);
  in.required("right_rad_s", command.right_rad_s);
  check(in, "duration_s", command.duration_s, 0.0, 1e9);
  out.plan.commands.push_back(command);
  return in.finish();
}

Failure read_patch(const std::string& file, const toml::table& table, RoverScenario& out) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  sim::SoilPatch patch{-kInfinity, kInfinity, -kInfinity, kInfinity, kUnknown};
  TomlSection in(file, &table, "patch");
  std::string soil;
  in.optional("soil", soil);
  in.optional("efficiency_ratio", patch.efficiency_ratio);
  in.optional("left_m", patch.left_m);
  in.optional("right_m", patch.right_m);
  in.optional("bottom_m", patch.bottom_m);
  in.optional("top_m", patch.top_m);
  if (!soil.empty()) {
    const std::optional<double> efficiency = sim::soil_efficiency(soil);
    if (!efficiency) in.fail("soil", "must be A, B, C, D or E");
    patch.efficiency_ratio = efficiency.value_or(1.0);
  }
  if (!(patch.efficiency_ratio >= 0.0 && patch.efficiency_ratio <= 2.0))
    in.fail("efficiency_ratio", "must be between 0 and 2, or soil must be given");
  out.plan.patches.push_back(patch);
  return in.finish();
}

Failure read_side_slip(const std::string& file, const toml::table& table, RoverScenario& out) {
  sim::SideSlip slip;
  TomlSection in(file, &table, "side_slip");
  in.required("begin_s", slip.begin_s);
  in.required("end_s", slip.end_s);
  in.required("vy_m_s", slip.vy_m_s);
  out.plan.side_slips.push_back(slip);
  return in.finish();
}

Failure read_random(const std::string& file, const toml::table* table, RoverScenario& out) {
  if (table == nullptr) return std::nullopt;
  sim::RandomDrive random;
  TomlSection in(file, table, "random");
  in.optional("vx_m_s", random.vx_m_s);
  in.optional("vx_walk_m_s", random.vx_walk_m_s);
  in.optional("wz_walk_rad_s", random.wz_walk_rad_s);
  in.optional("vy_sigma_m_s", random.vy_sigma_m_s);
  in.optional("vy_time_s", random.vy_time_s);
  in.optional("efficiency_sigma_ratio", random.efficiency_sigma_ratio);
  in.optional("efficiency_time_s", random.efficiency_time_s);
  for (const auto& [key, value] : {std::pair{"vx_walk_m_s", random.vx_walk_m_s},
                                   {"wz_walk_rad_s", random.wz_walk_rad_s},
                                   {"vy_time_s", random.vy_time_s},
                                   {"efficiency_time_s", random.efficiency_time_s}})
    check(in, key, value, 1e-9, 1e9);
  out.plan.random = random;
  return in.finish();
}

Failure read_wheels(const std::string& file, const toml::table* table, RoverScenario& out) {
  TomlSection in(file, table, "wheels");
  in.required("radius_m", out.plan.radius_m);
  in.required("track_m", out.plan.track_m);
  in.optional("noise_rad_s", out.encoders.noise_rad_s);
  double ticks = kUnknown;
  in.optional("ticks_per_turn", ticks);
  if (!std::isnan(ticks)) {
    check(in, "ticks_per_turn", ticks, 1.0, 1e9);
    out.encoders.ticks_per_turn = ticks;
  }
  check(in, "radius_m", out.plan.radius_m, 1e-4, 100.0);
  check(in, "track_m", out.plan.track_m, 1e-4, 100.0);
  check(in, "noise_rad_s", out.encoders.noise_rad_s, 0.0, 1e6);
  return in.finish();
}

Failure read_lsv(const std::string& file, const toml::table& table, RoverScenario& out) {
  ScenarioSensor sensor{.name = "LSV " + std::to_string(out.lsv.size() + 1), .config = {}};
  TomlSection in(file, &table, "lsv");
  in.optional("name", sensor.name);
  in.required("x_m", sensor.config.place.x_m);
  in.required("y_m", sensor.config.place.y_m);
  in.optional("yaw_rad", sensor.config.place.yaw_rad);
  in.required("noise_m_s", sensor.config.noise_m_s);
  in.optional("outlier_share", sensor.config.outlier_share);
  in.optional("outlier_m_s", sensor.config.outlier_m_s);
  sim::Interval lost;
  in.optional("lost_from_s", lost.begin_s);
  in.optional("lost_to_s", lost.end_s);
  if (lost.end_s > lost.begin_s) sensor.config.lost.push_back(lost);
  check(in, "noise_m_s", sensor.config.noise_m_s, 1e-12, 1e3);
  check(in, "outlier_share", sensor.config.outlier_share, 0.0, 1.0);
  out.lsv.push_back(std::move(sensor));
  return in.finish();
}

Failure read_imu(const std::string& file, const toml::table* table, RoverScenario& out) {
  if (table == nullptr) return std::nullopt;
  ScenarioImu imu;
  TomlSection in(file, table, "imu");
  in.required("gyro_noise_rad_s", imu.config.gyro_noise_rad_s);
  in.optional("gyro_bias_rad_s", imu.config.gyro_bias_rad_s);
  in.optional("gyro_bias_sigma_rad_s", imu.bias_sigma_rad_s);
  in.optional("accelerometer_noise_m_s2", imu.config.accelerometer_noise_m_s2);
  check(in, "gyro_noise_rad_s", imu.config.gyro_noise_rad_s, 1e-12, 1e3);
  out.imu = imu;
  return in.finish();
}

Failure read_motion(const std::string& file, const toml::table* table, RoverScenario& out) {
  if (table == nullptr) return std::nullopt;
  ScenarioMotion motion;
  TomlSection in(file, table, "motion");
  in.required("vx_walk_m_s", motion.vx_walk_m_s);
  in.required("wz_walk_rad_s", motion.wz_walk_rad_s);
  check(in, "vx_walk_m_s", motion.vx_walk_m_s, 1e-9, 1e9);
  check(in, "wz_walk_rad_s", motion.wz_walk_rad_s, 1e-9, 1e9);
  out.motion = motion;
  return in.finish();
}

Error at(const std::string& file, const toml::node& node, const std::string& sentence) {
  return {ErrorCode::bad_input,
          file + ":" + std::to_string(node.source().begin.line) + ": " + sentence};
}

Failure read_all(const std::string& file, const toml::table& root, RoverScenario& out) {
  for (const auto& [key, node] : root) {
    if (std::ranges::find(kSections, key.str()) == kSections.end())
      return Error{ErrorCode::bad_input, file + ":" + std::to_string(key.source().begin.line) +
                                             ": unknown section " + std::string(key.str()) +
                                             "; docs/formats.md lists those of a scenario"};
  }
  if (root["schema"].value_or(std::string()) != kSchema)
    return Error{ErrorCode::bad_input, file + ": schema must be \"" + kSchema + "\""};
  using ReadTable = Failure (*)(const std::string&, const toml::table*, RoverScenario&);
  constexpr std::pair<const char*, ReadTable> kTables[] = {{"drive", read_drive},
                                                           {"wheels", read_wheels},
                                                           {"random", read_random},
                                                           {"imu", read_imu},
                                                           {"motion", read_motion}};
  for (const auto& [name, read] : kTables) {
    const toml::node* const node = root.get(name);
    if (node != nullptr && !node->is_table())
      return at(file, *node, std::string(name) + " must be a section, [" + name + "]");
    if (Failure failure = read(file, node == nullptr ? nullptr : node->as_table(), out))
      return failure;
  }
  using ReadEach = Failure (*)(const std::string&, const toml::table&, RoverScenario&);
  constexpr std::pair<const char*, ReadEach> kLists[] = {{"command", read_command},
                                                         {"patch", read_patch},
                                                         {"side_slip", read_side_slip},
                                                         {"lsv", read_lsv}};
  for (const auto& [name, read] : kLists) {
    const toml::node* const node = root.get(name);
    if (node == nullptr) continue;
    const std::string form = std::string(name) + " must be given as [[" + name + "]]";
    if (!node->is_array()) return at(file, *node, form);
    for (const toml::node& one : *node->as_array()) {
      if (!one.is_table()) return at(file, one, form);
      if (Failure failure = read(file, *one.as_table(), out)) return failure;
    }
  }
  if (out.plan.random.has_value() == !out.plan.commands.empty())
    return Error{ErrorCode::bad_input, file + ": give [[command]] or [random], one of the two"};
  if (out.plan.random && out.motion)
    return Error{ErrorCode::bad_input, file + ": [random] says already what [motion] would"};
  return std::nullopt;
}

void line(std::string& out, const char* key, double value) {
  out += key;
  out += " = ";
  std::string number;
  append_shortest(number, value);
  // TOML takes 5 for a whole number, which is as good.
  out += number + "\n";
}

}  // namespace

std::vector<ScenarioName> scenario_names() {
  std::vector<ScenarioName> out;
  for (const Named& one : kScenarios) out.push_back({one.name, sentence_of(*one.text)});
  return out;
}

Result<RoverScenario> parse_scenario(const std::string& text, const std::string& file) {
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    return Error{ErrorCode::bad_input,
                 file + ":" + std::to_string(parsed.error().source().begin.line) +
                     ": not valid TOML: " + std::string(parsed.error().description())};
  }
  RoverScenario out{.text = text, .plan = {}, .encoders = {}, .lsv = {}, .imu = {}, .motion = {}};
  if (Failure failure = read_all(file, parsed.table(), out)) return *failure;
  return out;
}

Result<RoverScenario> load_scenario(const std::string& name_or_path) {
  for (const Named& one : kScenarios) {
    if (name_or_path == one.name)
      return parse_scenario(std::string(*one.text), name_or_path + ".toml");
  }
  std::error_code status;
  if (!std::filesystem::exists(name_or_path, status)) {
    return Error{ErrorCode::invalid_argument,
                 "'" + name_or_path + "' is neither a scenario (--list names them) nor a file"};
  }
  const Result<std::string> text = read_text_file(name_or_path, "scenario");
  if (!text) return text.error();
  return parse_scenario(text.value(), name_or_path);
}

std::string rover_toml(const RoverScenario& scenario) {
  const sim::RoverPlan& plan = scenario.plan;
  std::string out = "schema = \"lsv.rover/1\"\n\n[wheels]\n";
  line(out, "radius_m", plan.radius_m);
  line(out, "track_m", plan.track_m);
  line(out, "noise_rad_s", std::max(kLeastNoise_rad_s, scenario.encoders.noise_rad_s));
  if (scenario.encoders.ticks_per_turn)
    line(out, "ticks_per_turn", *scenario.encoders.ticks_per_turn);
  for (const ScenarioSensor& sensor : scenario.lsv) {
    out += "\n[[lsv]]\nname = '" + sensor.name + "'\n";
    line(out, "x_m", sensor.config.place.x_m);
    line(out, "y_m", sensor.config.place.y_m);
    line(out, "yaw_rad", sensor.config.place.yaw_rad);
    line(out, "noise_m_s", sensor.config.noise_m_s);
  }
  if (scenario.imu) {
    out += "\n[imu]\n";
    line(out, "gyro_noise_rad_s", scenario.imu->config.gyro_noise_rad_s);
    line(out, "gyro_bias_sigma_rad_s", scenario.imu->bias_sigma_rad_s);
  }
  out += "\n[start]\n";
  line(out, "x_m", plan.start_x_m);
  line(out, "y_m", plan.start_y_m);
  line(out, "yaw_rad", plan.start_yaw_rad);
  if (scenario.motion) {
    out += "\n[motion]\n";
    line(out, "vx_walk_m_s", scenario.motion->vx_walk_m_s);
    line(out, "wz_walk_rad_s", scenario.motion->wz_walk_rad_s);
  }
  if (!plan.random) return out;
  const sim::RandomDrive& random = *plan.random;
  out += "\n[motion]\n";
  line(out, "vx_walk_m_s", random.vx_walk_m_s);
  line(out, "wz_walk_rad_s", random.wz_walk_rad_s);
  line(out, "vy_sigma_m_s", random.vy_sigma_m_s);
  line(out, "vy_time_s", random.vy_time_s);
  line(out, "efficiency_sigma_ratio", random.efficiency_sigma_ratio);
  line(out, "efficiency_time_s", random.efficiency_time_s);
  return out;
}

}  // namespace lsv::cli
