// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/config.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace lsv {
namespace {

constexpr std::array kPresets = {std::pair{Preset::precise, std::string_view("precise")},
                                 std::pair{Preset::fast, std::string_view("fast")},
                                 std::pair{Preset::classic, std::string_view("classic")}};

constexpr std::array kEngines = {std::pair{Engine::zncc, std::string_view("zncc")},
                                 std::pair{Engine::cross, std::string_view("cross")},
                                 std::pair{Engine::phase, std::string_view("phase")},
                                 std::pair{Engine::direct, std::string_view("direct")}};

constexpr std::array kPeakFits = {std::pair{PeakFit::sinc, std::string_view("sinc")},
                                  std::pair{PeakFit::gaussian2d, std::string_view("gaussian2d")},
                                  std::pair{PeakFit::gaussian3, std::string_view("gaussian3")},
                                  std::pair{PeakFit::parabola3, std::string_view("parabola3")}};

template <typename Table, typename Value>
std::string_view word_in(const Table& table, Value value) {
  for (const auto& [candidate, name] : table) {
    if (candidate == value) return name;
  }
  return "unknown";
}

template <typename Value, typename Table>
std::optional<Value> value_in(const Table& table, std::string_view name) {
  for (const auto& [candidate, candidate_name] : table) {
    if (candidate_name == name) return candidate;
  }
  return std::nullopt;
}

Error out_of_range(const char* name, double value, const char* rule) {
  char text[160];
  std::snprintf(text, sizeof text, "%s is %g but must be %s", name, value, rule);
  return {ErrorCode::invalid_argument, text};
}

bool within(double value, double low, double high) { return value >= low && value <= high; }
bool positive(double value) { return std::isfinite(value) && value > 0.0; }
bool not_negative(double value) { return std::isfinite(value) && value >= 0.0; }

}  // namespace

std::optional<Preset> preset_from(std::string_view name) {
  return value_in<Preset>(kPresets, name);
}
std::optional<Engine> engine_from(std::string_view name) {
  return value_in<Engine>(kEngines, name);
}
std::optional<PeakFit> peak_fit_from(std::string_view name) {
  return value_in<PeakFit>(kPeakFits, name);
}
std::string_view word(Preset preset) { return word_in(kPresets, preset); }
std::string_view word(Engine engine) { return word_in(kEngines, engine); }
std::string_view word(PeakFit fit) { return word_in(kPeakFits, fit); }

Result<void> validate(const TrackConfig& config) {
  const auto& [preset, measure_deformation, learn_fixed_pattern, correlation, gate, calibration,
               sensor_maps] = config;
  if (measure_deformation && preset == Preset::classic)
    return Error{ErrorCode::invalid_argument,
                 "deformation is not measured by the preset classic: use precise or fast"};
  if (correlation.max_shift_px && *correlation.max_shift_px < 2)
    return out_of_range("max_shift_px", *correlation.max_shift_px, "at least 2");
  if (!within(gate.min_zncc, -1.0, 1.0))
    return out_of_range("min_zncc", gate.min_zncc, "in [-1, 1]");
  if (!not_negative(gate.min_zncc_sigmas))
    return out_of_range("min_zncc_sigmas", gate.min_zncc_sigmas, "zero or more");
  if (!not_negative(gate.min_q)) return out_of_range("min_q", gate.min_q, "zero or more");
  if (!not_negative(gate.min_peak_ratio))
    return out_of_range("min_peak_ratio", gate.min_peak_ratio, "zero or more");
  if (!within(gate.min_signal_fraction, 0.0, 1.0))
    return out_of_range("min_signal_fraction", gate.min_signal_fraction, "in [0, 1]");
  if (!within(gate.max_saturated_fraction, 0.0, 1.0))
    return out_of_range("max_saturated_fraction", gate.max_saturated_fraction, "in [0, 1]");
  if (!not_negative(gate.min_contrast_to_noise))
    return out_of_range("min_contrast_to_noise", gate.min_contrast_to_noise, "zero or more");
  if (!positive(calibration.pixel_pitch_x_m))
    return out_of_range("pixel_pitch_x_m", calibration.pixel_pitch_x_m, "finite and positive");
  if (!positive(calibration.pixel_pitch_y_m))
    return out_of_range("pixel_pitch_y_m", calibration.pixel_pitch_y_m, "finite and positive");
  if (!positive(calibration.sc_x_ratio))
    return out_of_range("sc_x_ratio", calibration.sc_x_ratio, "finite and positive");
  if (!positive(calibration.sc_y_ratio))
    return out_of_range("sc_y_ratio", calibration.sc_y_ratio, "finite and positive");
  if (!not_negative(calibration.noise_mean_counts))
    return out_of_range("noise_mean_counts", calibration.noise_mean_counts, "zero or more");
  if (!not_negative(calibration.noise_sd_counts))
    return out_of_range("noise_sd_counts", calibration.noise_sd_counts, "zero or more");
  return {};
}

}  // namespace lsv
