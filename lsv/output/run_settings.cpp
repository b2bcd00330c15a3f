// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/run_settings.h"

#include <algorithm>
#include <cmath>

#include "lsv/output/number_text.h"

namespace lsv {
namespace {

struct ValueText {
  std::string operator()(const std::string& value) const {
    std::string out = value;
    std::ranges::replace_if(
        out, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    return out;
  }
  std::string operator()(double value) const {
    std::string out;
    append_shortest(out, value);
    return out.empty() ? "unknown" : out;
  }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
};

std::int64_t whole(int value) { return value; }

}  // namespace

std::vector<Setting> run_settings(const RunInfo& info) {
  const auto& [preset, measure_deformation, learn_fixed_pattern, correlation, gate, calibration,
               sensor_maps] = info.config;
  return {
      {"lsv_version", info.version},
      {"source", info.source_description},
      {"frame_width_px", whole(info.format.width_px)},
      {"frame_height_px", whole(info.format.height_px)},
      {"bit_depth", whole(info.format.bit_depth)},
      {"time_base", info.time_base},
      {"index_step", info.index_step},
      {"preset", std::string(word(preset))},
      {"deformation", measure_deformation},
      {"learn_fixed_pattern", learn_fixed_pattern},
      {"sensor_maps", sensor_maps != nullptr},
      {"engine", std::string(word(correlation.engine))},
      {"peak_fit", std::string(word(correlation.peak_fit))},
      {"max_shift_x_px", whole(info.max_shift.max_dx_px)},
      {"max_shift_y_px", whole(info.max_shift.max_dy_px)},
      {"min_zncc", gate.min_zncc},
      {"min_zncc_sigmas", gate.min_zncc_sigmas},
      {"min_q", gate.min_q},
      {"min_peak_ratio", gate.min_peak_ratio},
      {"min_signal_fraction", gate.min_signal_fraction},
      {"max_saturated_fraction", gate.max_saturated_fraction},
      {"min_contrast_to_noise", gate.min_contrast_to_noise},
      {"refuse_frozen", gate.refuse_frozen},
      {"refuse_inconsistent", gate.refuse_inconsistent},
      {"sensor_name", calibration.sensor_name},
      {"calibration_sha256", calibration.digest},
      {"pixel_pitch_x_m", calibration.pixel_pitch_x_m},
      {"pixel_pitch_y_m", calibration.pixel_pitch_y_m},
      {"sc_x_ratio", calibration.sc_x_ratio},
      {"sc_y_ratio", calibration.sc_y_ratio},
      {"noise_mean_counts", calibration.noise_mean_counts},
      {"noise_sd_counts", calibration.noise_sd_counts},
  };
}

std::string value_text(const Setting& setting) { return std::visit(ValueText{}, setting.value); }

}  // namespace lsv
