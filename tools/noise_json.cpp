// SPDX-License-Identifier: BSD-3-Clause
// The report of `lsv calibrate noise` for programs: SI units, null where unknown.
#include <nlohmann/json.hpp>

#include "tools/noise_report.h"

namespace lsv::cli {
namespace {

using nlohmann::ordered_json;

ordered_json parts_json(const NoiseParts& p, double sigma_px) {
  return {{"sigma_px", sigma_px},
          {"noise_px", p.noise_px},
          {"boiling_px", p.boiling_px},
          {"clipping_px", p.clipping_px},
          {"interpolation_px", p.interpolation_px}};
}

ordered_json input_json(const NoiseReport& r) {
  const NoiseConditions& c = r.input.conditions;
  return {{"sensor", r.input.calibration.sensor_name},
          {"calibration_sha256", r.input.calibration.digest},
          {"width_px", c.width_px},
          {"height_px", c.height_px},
          {"bit_depth", c.bit_depth},
          {"rate_hz", r.input.rate_hz},
          {"exposure_s", r.input.exposure_s},
          {"speed_m_s", r.input.speed_m_s},
          {"speckle_px", c.speckle_px},
          {"shift_px", c.shift_px},
          {"blur_px", c.blur_px},
          {"mean_signal_counts", c.mean_signal_counts},
          {"dark_counts", c.dark_counts},
          {"noise_sd_counts", c.noise_sd_counts},
          {"electrons_per_count", c.electrons_per_count},
          {"rho", c.rho},
          {"update_hz", r.input.update_hz}};
}

ordered_json pair_json(const NoiseReport& r) {
  const NoisePrediction& p = r.pair;
  return {{"in_range", p.range == NoiseRange::inside},
          {"range", advice(p.range)},
          {"x", parts_json(p.x, p.sigma_x_px)},
          {"y", parts_json(p.y, p.sigma_y_px)},
          {"velocity_sigma_x_m_s", velocity_sigma_m_s(r.scale_x, p.sigma_x_px)},
          {"velocity_sigma_y_m_s", velocity_sigma_m_s(r.scale_y, p.sigma_y_px)},
          {"zncc", p.zncc},
          {"zncc_sigmas", p.zncc_sigmas}};
}

ordered_json tracking_json(const NoiseReport& r) {
  const TrackingNoise& t = r.tracking;
  return {{"step_sigma_x_px", t.step_x_px},
          {"step_sigma_y_px", t.step_y_px},
          {"velocity_sigma_x_m_s", velocity_sigma_m_s(r.scale_x, t.step_x_px)},
          {"velocity_sigma_y_m_s", velocity_sigma_m_s(r.scale_y, t.step_y_px)},
          {"drift_x_px2_per_frame", t.drift_x_px2},
          {"drift_y_px2_per_frame", t.drift_y_px2},
          {"frames_per_keyframe", t.frames_per_keyframe}};
}

ordered_json sweeps_json(const NoiseReport& r) {
  ordered_json out = ordered_json::object();
  for (const NoiseSweep& sweep : r.sweeps) {
    ordered_json rows = ordered_json::array();
    for (const NoiseSweep::At& at : sweep.table) {
      rows.push_back({{std::string(sweep.key), at.value},
                      {"sigma_x_px", at.sigma_x_px},
                      {"sigma_y_px", at.sigma_y_px}});
    }
    out[std::string(sweep.key)] = std::move(rows);
  }
  return out;
}

ordered_json choice_json(const Choice& c) {
  return {{"window_px", c.window_px},
          {"rate_hz", c.rate_hz},
          {"exposure_s", c.exposure_s},
          {"shift_px", c.shift_px},
          {"blur_px", c.blur_px},
          {"mean_signal_counts", c.mean_signal_counts},
          {"zncc_sigmas", c.zncc_sigmas},
          {"frame_sigma_m_s", c.frame_sigma_m_s},
          {"update_sigma_m_s", c.update_sigma_m_s},
          {"distance_sigma_per_root_m_m", c.distance_sigma_m},
          {"push_load_ratio", c.push_load_ratio}};
}

ordered_json recommendation_json(const NoiseReport& r) {
  ordered_json windows = ordered_json::array();
  for (const WindowChoice& window : r.recommendation.windows) {
    windows.push_back(window.best ? choice_json(*window.best)
                                  : ordered_json{{"window_px", window.window_px},
                                                 {"not_possible", advice(window.limit)}});
  }
  return {
      {"best", r.recommendation.best ? choice_json(*r.recommendation.best) : ordered_json(nullptr)},
      {"reasons", r.reasons},
      {"windows", std::move(windows)}};
}

}  // namespace

std::string noise_json(const NoiseReport& r) {
  const ordered_json json = {{"schema", "lsv.noise/1"},  {"input", input_json(r)},
                             {"pair", pair_json(r)},     {"tracking", tracking_json(r)},
                             {"sweeps", sweeps_json(r)}, {"recommendation", recommendation_json(r)},
                             {"warnings", r.warnings}};
  return json.dump(2) + "\n";
}

}  // namespace lsv::cli
