// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/calibration_io.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <sstream>

#include "calibration/sha256.h"
#include "calibration/text_file.h"
#include "calibration/toml.h"

namespace lsv {
namespace {

constexpr std::string_view kSchema = "lsv.calibration/2";
// The same without the optional sections.
constexpr std::string_view kFirstSchema = "lsv.calibration/1";

/// Beyond these bounds a number is a slip, such as 14 for 14e-6.
struct Bounds {
  double lowest = 0.0;
  double highest = 0.0;
};
constexpr Bounds kPitch_m{1e-8, 1e-2};
constexpr Bounds kRatio{1e-4, 1e4};
constexpr Bounds kCounts{0.0, 65535.0};
constexpr Bounds kAngle_rad{-std::numbers::pi, std::numbers::pi};
constexpr Bounds kSkew_rad{-0.5, 0.5};
constexpr Bounds kSigma{1e-15, 1e3};
constexpr Bounds kHeight_m{1e-4, 100.0};
constexpr Bounds kLever_m{-100.0, 100.0};
constexpr Bounds kSide_px{1.0, 65535.0};
constexpr Bounds kBits{8.0, 16.0};
constexpr Bounds kK_counts_per_e{1e-7, 1e5};
constexpr Bounds kNoise_e{0.0, 1e8};
constexpr Bounds kPrnu_ratio{0.0, 1.0};
constexpr Bounds kSaturation_counts{1.0, 65535.0};
constexpr Bounds kSaturation_e{1e-3, 1e12};
constexpr Bounds kCameraSigma{1e-15, 1e12};
constexpr Bounds kFrames{2.0, 1e9};

constexpr int kSections = 7;
struct Section {
  const char* name;
  bool required;
};
constexpr Section kAllSections[kSections] = {
    {"sensor", true}, {"camera", true},    {"scale", false}, {"format", false},
    {"maps", false},  {"emva1288", false}, {"mount", false}};

/// Order of scale.correlations: the pairs of the four uncertain figures, row by row.
constexpr std::pair<std::size_t, std::size_t> kPairs[] = {{0, 1}, {0, 2}, {0, 3},
                                                          {1, 2}, {1, 3}, {2, 3}};
constexpr const char* kSigmaKeys[] = {"sigma_sc_x_ratio", "sigma_sc_y_ratio", "sigma_angle_rad",
                                      "sigma_skew_rad"};

/// Reads one section key by key; the first thing that is wrong is kept, what follows is skipped.
class SectionReader {
 public:
  SectionReader(const std::string& file, const toml::table& table, const std::string& section)
      : file_(file), table_(table), section_(section) {}

  double number(const char* key, const Bounds& bounds) {
    const toml::node* const node = find(key);
    if (node == nullptr) return kUnknown;
    if (!node->is_number()) return fail(*node, key, "must be a number"), kUnknown;
    const double value = *node->value<double>();
    if (!(value >= bounds.lowest && value <= bounds.highest)) {
      std::ostringstream sentence;
      sentence << "is " << value << " but must be between " << bounds.lowest << " and "
               << bounds.highest;
      fail(*node, key, sentence.str());
    }
    return value;
  }

  int whole(const char* key, const Bounds& bounds) {
    const double value = number(key, bounds);
    if (!error_ && value != std::floor(value))
      fail(*table_.get(key), key, "must be a whole number");
    return error_ ? 0 : static_cast<int>(value);
  }

  std::string text(const char* key) {
    const toml::node* const node = find(key);
    if (node == nullptr) return {};
    if (!node->is_string()) return fail(*node, key, "must be a text in quotes"), std::string();
    return node->as_string()->get();
  }

  bool truth(const char* key) {
    const toml::node* const node = find(key);
    if (node == nullptr) return false;
    if (!node->is_boolean()) return fail(*node, key, "must be true or false"), false;
    return node->as_boolean()->get();
  }

  /// Correlation coefficients, one per pair.
  std::array<double, std::size(kPairs)> correlations(const char* key) {
    std::array<double, std::size(kPairs)> out{};
    const toml::node* const node = find(key);
    if (node == nullptr) return out;
    const toml::array* const array = node->as_array();
    if (array == nullptr || array->size() != out.size())
      return fail(*node, key, "must be a list of 6 numbers"), out;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::optional<double> value = array->get(i)->value<double>();
      if (!value || !(std::abs(*value) <= 1.0))
        return fail(*node, key, "must hold numbers between -1 and 1"), out;
      out[i] = *value;
    }
    return out;
  }

  void fail(const toml::node& node, const std::string& key, const std::string& sentence) {
    if (error_) return;
    error_ = Error{ErrorCode::bad_input, file_ + ":" + std::to_string(node.source().begin.line) +
                                             ": " + section_ + "." + key + " " + sentence};
  }
  bool ok() const { return !error_; }
  const toml::node& node(const char* key) const { return *table_.get(key); }

  /// A key that nobody asked for is told before one that is missing: it is that key misspelt.
  std::optional<Error> finish() {
    for (const auto& [key, node] : table_) {
      if (std::ranges::find(asked_, key.str()) != asked_.end()) continue;
      return Error{ErrorCode::bad_input, file_ + ":" + std::to_string(key.source().begin.line) +
                                             ": unknown key " + section_ + "." +
                                             std::string(key.str()) +
                                             "; docs/formats.md lists the keys of a calibration"};
    }
    return error_;
  }

 private:
  const toml::node* find(const char* key) {
    asked_.emplace_back(key);
    if (error_) return nullptr;
    const toml::node* const node = table_.get(key);
    if (node == nullptr)
      error_ =
          Error{ErrorCode::bad_input, file_ + ": the key " + section_ + "." + key + " is missing"};
    return node;
  }

  const std::string& file_;
  const toml::table& table_;
  std::string section_;
  std::vector<std::string_view> asked_;
  std::optional<Error> error_;
};

void read_sensor(SectionReader& in, Calibration& out) {
  out.sensor_name = in.text("name");
  out.pixel_pitch_x_m = in.number("pixel_pitch_x_m", kPitch_m);
  out.pixel_pitch_y_m = in.number("pixel_pitch_y_m", kPitch_m);
  out.sc_x_ratio = in.number("sc_x_ratio", kRatio);
  out.sc_y_ratio = in.number("sc_y_ratio", kRatio);
}

void read_camera(SectionReader& in, Calibration& out) {
  out.noise_mean_counts = in.number("noise_mean_counts", kCounts);
  out.noise_sd_counts = in.number("noise_sd_counts", kCounts);
}

void read_scale(SectionReader& in, Calibration& out) {
  ScaleRecord scale;
  scale.orientation = {.angle_rad = in.number("angle_rad", kAngle_rad),
                       .skew_rad = in.number("skew_rad", kSkew_rad),
                       .mirrored = in.truth("mirrored")};
  std::array<double, 4> sigmas{};
  for (std::size_t i = 0; i < sigmas.size(); ++i) sigmas[i] = in.number(kSigmaKeys[i], kSigma);
  const auto correlations = in.correlations("correlations");
  Eigen::Matrix4d correlation = Eigen::Matrix4d::Identity();
  for (std::size_t i = 0; i < sigmas.size(); ++i) scale.cov[i][i] = sigmas[i] * sigmas[i];
  for (std::size_t k = 0; k < correlations.size(); ++k) {
    const auto [i, j] = kPairs[k];
    scale.cov[i][j] = scale.cov[j][i] = correlations[k] * sigmas[i] * sigmas[j];
    correlation(static_cast<int>(i), static_cast<int>(j)) = correlations[k];
    correlation(static_cast<int>(j), static_cast<int>(i)) = correlations[k];
  }
  scale.height_m = in.number("height_m", kHeight_m);
  scale.date = in.text("date");
  scale.method = in.text("method");
  scale.inputs_sha256 = in.text("inputs_sha256");
  constexpr double kRounding = -1e-6;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(correlation, Eigen::EigenvaluesOnly);
  if (in.ok() && !(eigen.eigenvalues().minCoeff() > kRounding))
    in.fail(in.node("correlations"), "correlations", "cannot all hold at once");
  out.scale = std::move(scale);
}

void read_format(SectionReader& in, Calibration& out) {
  out.format = SensorFormat{.width_px = in.whole("width_px", kSide_px),
                            .height_px = in.whole("height_px", kSide_px),
                            .bit_depth = in.whole("bit_depth", kBits)};
}

void read_maps(SectionReader& in, Calibration& out) {
  out.maps = MapsRecord{.file = in.text("file"), .sha256 = in.text("sha256")};
}

void read_emva1288(SectionReader& in, Calibration& out) {
  CameraRecord camera;
  camera.k_counts_per_e = in.number("k_counts_per_e", kK_counts_per_e);
  camera.sigma_k_counts_per_e = in.number("sigma_k_counts_per_e", kCameraSigma);
  camera.dark_noise_e = in.number("dark_noise_e", kNoise_e);
  camera.sigma_dark_noise_e = in.number("sigma_dark_noise_e", kCameraSigma);
  camera.dsnu_e = in.number("dsnu_e", kNoise_e);
  camera.sigma_dsnu_e = in.number("sigma_dsnu_e", kCameraSigma);
  camera.prnu_ratio = in.number("prnu_ratio", kPrnu_ratio);
  camera.sigma_prnu_ratio = in.number("sigma_prnu_ratio", kCameraSigma);
  camera.saturation_counts = in.number("saturation_counts", kSaturation_counts);
  camera.sigma_saturation_counts = in.number("sigma_saturation_counts", kCameraSigma);
  camera.saturation_e = in.number("saturation_e", kSaturation_e);
  camera.sigma_saturation_e = in.number("sigma_saturation_e", kCameraSigma);
  camera.saturation_reached = in.truth("saturation_reached");
  camera.dark_frames = in.whole("dark_frames", kFrames);
  camera.flat_frames = in.whole("flat_frames", kFrames);
  camera.flat_levels = in.whole("flat_levels", kFrames);
  camera.date = in.text("date");
  camera.method = in.text("method");
  camera.inputs_sha256 = in.text("inputs_sha256");
  out.camera = std::move(camera);
}

void read_mount(SectionReader& in, Calibration& out) {
  out.mount = Mount{.x_m = in.number("x_m", kLever_m),
                    .y_m = in.number("y_m", kLever_m),
                    .yaw_rad = in.number("yaw_rad", kAngle_rad),
                    .sigma_x_m = in.number("sigma_x_m", kSigma),
                    .sigma_y_m = in.number("sigma_y_m", kSigma),
                    .sigma_yaw_rad = in.number("sigma_yaw_rad", kSigma)};
}

using ReadSection = void (*)(SectionReader&, Calibration&);
constexpr ReadSection kReaders[kSections] = {read_sensor, read_camera,   read_scale, read_format,
                                             read_maps,   read_emva1288, read_mount};

/// Reads one document and remembers its name for messages.
class Reader {
 public:
  explicit Reader(const std::string& name) : name_(name) {}

  Result<Calibration> read(const toml::table& document) const {
    if (auto error = check_top(document)) return *error;
    Calibration out;
    for (int i = 0; i < kSections; ++i) {
      const toml::node* const node = document.get(kAllSections[i].name);
      if (node == nullptr) continue;
      SectionReader section(name_, *node->as_table(), kAllSections[i].name);
      kReaders[i](section, out);
      if (auto error = section.finish()) return *error;
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

  std::optional<Error> check_top(const toml::table& document) const {
    for (const auto& [key, node] : document) {
      const std::string_view word = key.str();
      const bool known =
          word == "schema" || std::ranges::any_of(kAllSections, [word](const Section& section) {
            return word == section.name;
          });
      if (!known) {
        return at(key.source(), "unknown key " + std::string(key.str()) +
                                    "; docs/formats.md lists the keys of a calibration");
      }
    }
    const toml::node* const schema = document.get("schema");
    if (schema == nullptr) return missing("schema");
    const bool is_first = schema->value<std::string_view>() == kFirstSchema;
    if (!is_first && schema->value<std::string_view>() != kSchema)
      return at(schema->source(), "schema must be \"" + std::string(kSchema) + "\"");
    for (const auto& [name, required] : kAllSections) {
      const toml::node* const node = document.get(name);
      if (node == nullptr && required) return missing("[" + std::string(name) + "]");
      if (node == nullptr) continue;
      if (!node->is_table()) {
        return at(node->source(),
                  std::string(name) + " must be a table: [" + std::string(name) + "]");
      }
      if (is_first && !required) {
        return at(node->source(),
                  "[" + std::string(name) + "] needs schema = \"" + std::string(kSchema) + "\"");
      }
    }
    return std::nullopt;
  }

  std::string name_;
};

/// Writes one section line by line.
class SectionWriter {
 public:
  explicit SectionWriter(const char* section, std::string& text) : text_(text) {
    text_ += std::string("\n[") + section + "]\n";
  }
  void number(const char* key, double value) { line(key, number_text(value)); }
  void text(const char* key, const std::string& value) {
    std::ostringstream quoted;
    quoted << toml::value<std::string>(value);
    line(key, quoted.str());
  }
  void line(const char* key, const std::string& value) {
    text_ += std::string(key) + " = " + value + "\n";
  }
  /// The shortest text that reads back as the same number, and as a TOML number.
  static std::string number_text(double value) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
    return {buffer, end};
  }

 private:
  std::string& text_;
};

void write_scale(const ScaleRecord& scale, std::string& out) {
  SectionWriter section("scale", out);
  section.number("angle_rad", scale.orientation.angle_rad);
  section.number("skew_rad", scale.orientation.skew_rad);
  section.line("mirrored", scale.orientation.mirrored ? "true" : "false");
  for (std::size_t i = 0; i < std::size(kSigmaKeys); ++i)
    section.number(kSigmaKeys[i], std::sqrt(scale.cov[i][i]));
  std::string correlations = "[";
  for (const auto& [i, j] : kPairs) {
    if (correlations.size() > 1) correlations += ", ";
    correlations +=
        SectionWriter::number_text(scale.cov[i][j] / std::sqrt(scale.cov[i][i] * scale.cov[j][j]));
  }
  section.line("correlations", correlations +
                                   "]  # sc_x sc_y, sc_x angle, sc_x skew, sc_y angle, "
                                   "sc_y skew, angle skew");
  section.number("height_m", scale.height_m);
  section.text("date", scale.date);
  section.text("method", scale.method);
  section.text("inputs_sha256", scale.inputs_sha256);
}

void write_emva1288(const CameraRecord& camera, std::string& out) {
  SectionWriter section("emva1288", out);
  section.number("k_counts_per_e", camera.k_counts_per_e);
  section.number("sigma_k_counts_per_e", camera.sigma_k_counts_per_e);
  section.number("dark_noise_e", camera.dark_noise_e);
  section.number("sigma_dark_noise_e", camera.sigma_dark_noise_e);
  section.number("dsnu_e", camera.dsnu_e);
  section.number("sigma_dsnu_e", camera.sigma_dsnu_e);
  section.number("prnu_ratio", camera.prnu_ratio);
  section.number("sigma_prnu_ratio", camera.sigma_prnu_ratio);
  section.number("saturation_counts", camera.saturation_counts);
  section.number("sigma_saturation_counts", camera.sigma_saturation_counts);
  section.number("saturation_e", camera.saturation_e);
  section.number("sigma_saturation_e", camera.sigma_saturation_e);
  section.line("saturation_reached", camera.saturation_reached ? "true" : "false");
  section.number("dark_frames", camera.dark_frames);
  section.number("flat_frames", camera.flat_frames);
  section.number("flat_levels", camera.flat_levels);
  section.text("date", camera.date);
  section.text("method", camera.method);
  section.text("inputs_sha256", camera.inputs_sha256);
}

void write_mount(const Mount& mount, std::string& out) {
  SectionWriter section("mount", out);
  section.number("x_m", mount.x_m);
  section.number("y_m", mount.y_m);
  section.number("yaw_rad", mount.yaw_rad);
  section.number("sigma_x_m", mount.sigma_x_m);
  section.number("sigma_y_m", mount.sigma_y_m);
  section.number("sigma_yaw_rad", mount.sigma_yaw_rad);
}

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

std::string calibration_text(const Calibration& calibration) {
  std::string out = "schema = \"" + std::string(kSchema) + "\"\n";
  {
    SectionWriter section("sensor", out);
    section.text("name", calibration.sensor_name);
    section.number("pixel_pitch_x_m", calibration.pixel_pitch_x_m);
    section.number("pixel_pitch_y_m", calibration.pixel_pitch_y_m);
    section.number("sc_x_ratio", calibration.sc_x_ratio);
    section.number("sc_y_ratio", calibration.sc_y_ratio);
  }
  {
    SectionWriter section("camera", out);
    section.number("noise_mean_counts", calibration.noise_mean_counts);
    section.number("noise_sd_counts", calibration.noise_sd_counts);
  }
  if (calibration.scale) write_scale(*calibration.scale, out);
  if (calibration.format) {
    SectionWriter section("format", out);
    section.number("width_px", calibration.format->width_px);
    section.number("height_px", calibration.format->height_px);
    section.number("bit_depth", calibration.format->bit_depth);
  }
  if (calibration.maps) {
    SectionWriter section("maps", out);
    section.text("file", calibration.maps->file);
    section.text("sha256", calibration.maps->sha256);
  }
  if (calibration.camera) write_emva1288(*calibration.camera, out);
  if (calibration.mount) write_mount(*calibration.mount, out);
  return out;
}

}  // namespace lsv
