// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/calibration_io.h"

#include <algorithm>
#include <optional>
#include <span>
#include <sstream>

#include "calibration/sha256.h"
#include "calibration/text_file.h"
#include "calibration/toml.h"

namespace lsv {
namespace {

constexpr std::string_view kSchema = "lsv.calibration/1";

struct NumberKey {
  const char* section;
  const char* key;
  double Calibration::*member;
  // Beyond these bounds a number is a slip, such as 14 for 14e-6.
  double lowest;
  double highest;
};

constexpr NumberKey kNumbers[] = {
    {"sensor", "pixel_pitch_x_m", &Calibration::pixel_pitch_x_m, 1e-8, 1e-2},
    {"sensor", "pixel_pitch_y_m", &Calibration::pixel_pitch_y_m, 1e-8, 1e-2},
    {"sensor", "sc_x_ratio", &Calibration::sc_x_ratio, 1e-4, 1e4},
    {"sensor", "sc_y_ratio", &Calibration::sc_y_ratio, 1e-4, 1e4},
    {"camera", "noise_mean_counts", &Calibration::noise_mean_counts, 0.0, 65535.0},
    {"camera", "noise_sd_counts", &Calibration::noise_sd_counts, 0.0, 65535.0},
};

/// Reads one document and remembers its name for messages.
class Reader {
 public:
  explicit Reader(const std::string& name) : name_(name) {}

  Result<Calibration> read(const toml::table& document) const {
    if (auto error = check_keys(document)) return *error;
    Calibration out;
    if (auto error = check_schema(document)) return *error;
    if (auto error = read_name(document, out)) return *error;
    for (const NumberKey& entry : kNumbers) {
      if (auto error = read_number(document, entry, out)) return *error;
    }
    return out;
  }

  Error at(const toml::source_region& where, const std::string& sentence) const {
    return {ErrorCode::bad_input, name_ + ":" + std::to_string(where.begin.line) + ": " + sentence};
  }

 private:
  Error missing(const std::string& key) const {
    return {ErrorCode::bad_input, name_ + ": the key " + key + " is missing"};
  }

  static bool is_known(std::string_view section, std::string_view key) {
    if (section.empty()) return key == "schema" || key == "sensor" || key == "camera";
    if (section == "sensor" && key == "name") return true;
    return std::ranges::any_of(kNumbers, [&](const NumberKey& known) {
      return section == known.section && key == known.key;
    });
  }

  std::optional<Error> check_table(const toml::table& table, std::string_view section) const {
    for (const auto& [key, node] : table) {
      if (is_known(section, key.str())) continue;
      const std::string prefix = section.empty() ? "" : std::string(section) + ".";
      return at(key.source(), "unknown key " + prefix + std::string(key.str()) +
                                  "; docs/formats.md lists the keys of a calibration");
    }
    return std::nullopt;
  }

  std::optional<Error> check_keys(const toml::table& document) const {
    if (auto error = check_table(document, "")) return error;
    for (const char* section : {"sensor", "camera"}) {
      const toml::node* const node = document.get(section);
      if (node == nullptr) return missing(std::string("[") + section + "]");
      if (!node->is_table())
        return at(node->source(), std::string(section) + " must be a table: [" + section + "]");
      if (auto error = check_table(*node->as_table(), section)) return error;
    }
    return std::nullopt;
  }

  std::optional<Error> check_schema(const toml::table& document) const {
    const toml::node* const node = document.get("schema");
    if (node == nullptr) return missing("schema");
    if (node->value<std::string_view>() != kSchema)
      return at(node->source(), "schema must be \"" + std::string(kSchema) + "\"");
    return std::nullopt;
  }

  std::optional<Error> read_name(const toml::table& document, Calibration& out) const {
    const toml::node* const node = document["sensor"].as_table()->get("name");
    if (node == nullptr) return missing("sensor.name");
    if (!node->is_string()) return at(node->source(), "sensor.name must be a text in quotes");
    out.sensor_name = node->as_string()->get();
    return std::nullopt;
  }

  std::optional<Error> read_number(const toml::table& document, const NumberKey& entry,
                                   Calibration& out) const {
    const std::string key = std::string(entry.section) + "." + entry.key;
    const toml::node* const node = document[entry.section].as_table()->get(entry.key);
    if (node == nullptr) return missing(key);
    if (!node->is_number()) return at(node->source(), key + " must be a number");
    const double value = *node->value<double>();
    if (!(value >= entry.lowest && value <= entry.highest)) {
      std::ostringstream sentence;
      sentence << key << " is " << value << " but must be between " << entry.lowest << " and "
               << entry.highest;
      return at(node->source(), sentence.str());
    }
    out.*entry.member = value;
    return std::nullopt;
  }

  std::string name_;
};

}  // namespace

Result<Calibration> parse_calibration(std::string_view text, const std::string& name) {
  const Reader reader(name);
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    return reader.at(parsed.error().source(),
                     "not valid TOML: " + std::string(parsed.error().description()));
  }
  Result<Calibration> out = reader.read(parsed.table());
  if (out) out.value().digest = sha256_hex(text);
  return out;
}

Result<Calibration> load_calibration(const std::string& path) {
  const Result<std::string> text = read_text_file(path, "calibration");
  if (!text) return text.error();
  return parse_calibration(text.value(), path);
}

}  // namespace lsv
