// SPDX-License-Identifier: BSD-3-Clause
#include "tools/rover_file.h"

#include <algorithm>
#include <array>

#include "calibration/sha256.h"
#include "calibration/text_file.h"
#include "tools/toml_section.h"

namespace lsv::cli {
namespace {

constexpr const char* kSchema = "lsv.rover/1";
constexpr std::array kSections = {"schema", "wheels", "lsv",  "imu",
                                  "start",  "motion", "slip", "filter"};

using Failure = std::optional<Error>;

Error at(const std::string& file, const toml::node& node, const std::string& sentence) {
  return {ErrorCode::bad_input,
          file + ":" + std::to_string(node.source().begin.line) + ": " + sentence};
}

Failure read_wheels(const std::string& file, const toml::table& table, FusionConfig& out) {
  WheelConfig wheels;
  TomlSection in(file, &table, "wheels");
  in.required("radius_m", wheels.radius_m);
  in.required("track_m", wheels.track_m);
  in.required("noise_rad_s", wheels.noise_rad_s);
  double ticks = kUnknown;
  in.optional("ticks_per_turn", ticks);
  if (ticks == ticks) wheels.ticks_per_turn = ticks;
  out.wheels = wheels;
  return in.finish();
}

Failure read_lsv(const std::string& file, const toml::node& node, FusionConfig& out) {
  const toml::array* const all = node.as_array();
  if (all == nullptr) return at(file, node, "lsv must be given as [[lsv]], once per sensor");
  for (const toml::node& one : *all) {
    if (!one.is_table()) return at(file, one, "lsv must be given as [[lsv]], once per sensor");
    LsvConfig sensor;
    TomlSection in(file, one.as_table(), "lsv");
    sensor.name = "LSV " + std::to_string(out.lsv.size() + 1);
    in.optional("name", sensor.name);
    if (!is_sensor_name(sensor.name)) in.fail("name", kSensorNameRule);
    in.required("x_m", sensor.x_m);
    in.required("y_m", sensor.y_m);
    in.optional("yaw_rad", sensor.yaw_rad);
    in.required("noise_m_s", sensor.noise_m_s);
    in.optional("sigma_scale_ratio", sensor.sigma_scale_ratio);
    if (Failure failure = in.finish()) return failure;
    out.lsv.push_back(std::move(sensor));
  }
  return std::nullopt;
}

Failure read_imu(const std::string& file, const toml::table& table, FusionConfig& out) {
  GyroConfig gyro;
  TomlSection in(file, &table, "imu");
  in.required("gyro_noise_rad_s", gyro.noise_rad_s);
  in.optional("gyro_bias_sigma_rad_s", gyro.bias_sigma_rad_s);
  out.gyro = gyro;
  return in.finish();
}

Failure read_start(const std::string& file, const toml::table& table, FusionConfig& out) {
  TomlSection in(file, &table, "start");
  in.optional("x_m", out.start.x_m);
  in.optional("y_m", out.start.y_m);
  in.optional("yaw_rad", out.start.yaw_rad);
  in.optional("sigma_m", out.start.sigma_m);
  in.optional("sigma_yaw_rad", out.start.sigma_yaw_rad);
  return in.finish();
}

Failure read_motion(const std::string& file, const toml::table& table, FusionConfig& out) {
  MotionConfig& motion = out.motion;
  TomlSection in(file, &table, "motion");
  std::string model = "constant_velocity";
  in.optional("model", model);
  if (model == "constant_acceleration")
    motion.model = MotionModel::constant_acceleration;
  else if (model != "constant_velocity")
    in.fail("model", "must be \"constant_velocity\" or \"constant_acceleration\"");
  in.optional("vx_walk_m_s", motion.vx_walk_m_s);
  in.optional("wz_walk_rad_s", motion.wz_walk_rad_s);
  in.optional("ax_walk_m_s2", motion.ax_walk_m_s2);
  in.optional("az_walk_rad_s2", motion.az_walk_rad_s2);
  in.optional("vy_sigma_m_s", motion.vy_sigma_m_s);
  in.optional("vy_time_s", motion.vy_time_s);
  in.optional("efficiency_sigma_ratio", motion.efficiency_sigma_ratio);
  in.optional("efficiency_time_s", motion.efficiency_time_s);
  return in.finish();
}

Failure read_slip(const std::string& file, const toml::table& table, FusionConfig& out) {
  TomlSection in(file, &table, "slip");
  in.optional("alarm_ratio", out.slip.alarm_ratio);
  in.optional("threshold_sigmas", out.slip.threshold_sigmas);
  return in.finish();
}

Failure read_filter(const std::string& file, const toml::table& table, FusionConfig& out) {
  TomlSection in(file, &table, "filter");
  in.optional("gate_probability", out.gate_probability);
  in.optional_whole("max_rejected_in_a_row", out.max_rejected_in_a_row);
  in.optional("optical_timeout_s", out.optical_timeout_s);
  in.optional("same_time_s", out.same_time_s);
  int late_epochs = static_cast<int>(out.late_epochs);
  in.optional_whole("late_epochs", late_epochs);
  out.late_epochs = static_cast<std::size_t>(std::max(0, late_epochs));
  return in.finish();
}

Failure read_sections(const std::string& file, const toml::table& root, FusionConfig& out) {
  for (const auto& [key, node] : root) {
    if (std::ranges::find(kSections, key.str()) == kSections.end())
      return Error{ErrorCode::bad_input, file + ":" + std::to_string(key.source().begin.line) +
                                             ": unknown section " + std::string(key.str()) +
                                             "; docs/formats.md lists those of a rover"};
  }
  if (root["schema"].value_or(std::string()) != kSchema)
    return Error{ErrorCode::bad_input, file + ": schema must be \"" + kSchema + "\""};
  using ReadTable = Failure (*)(const std::string&, const toml::table&, FusionConfig&);
  const std::pair<const char*, ReadTable> tables[] = {
      {"wheels", read_wheels}, {"imu", read_imu},   {"start", read_start},
      {"motion", read_motion}, {"slip", read_slip}, {"filter", read_filter}};
  for (const auto& [name, read] : tables) {
    const toml::node* const node = root.get(name);
    if (node == nullptr) continue;
    if (!node->is_table())
      return at(file, *node, std::string(name) + " must be a section, [" + name + "]");
    if (Failure failure = read(file, *node->as_table(), out)) return failure;
  }
  if (const toml::node* const node = root.get("lsv")) return read_lsv(file, *node, out);
  return std::nullopt;
}

}  // namespace

bool is_sensor_name(std::string_view name) {
  constexpr std::size_t kLongest = 64;
  const auto is_wrong = [](char c) {
    return c == ',' || c == '\'' || c == '"' || static_cast<unsigned char>(c) < ' ' || c == '\x7f';
  };
  return !name.empty() && name.size() <= kLongest && std::ranges::none_of(name, is_wrong);
}

Result<RoverFile> read_rover(const std::string& path) {
  const Result<toml::table> root = read_toml(path);
  if (!root) return root.error();
  RoverFile out;
  if (Failure failure = read_sections(path, root.value(), out.config)) return *failure;
  if (const Result<void> valid = validate(out.config); !valid)
    return Error{ErrorCode::bad_input, path + ": " + valid.error().message};
  const Result<std::string> text = read_text_file(path, "rover");
  if (!text) return text.error();
  out.sha256 = sha256_hex(text.value());
  return out;
}

}  // namespace lsv::cli
