// SPDX-License-Identifier: BSD-3-Clause
#include "tools/camera_report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "lsv/output/number_text.h"
#include "lsv/output/svg.h"
#include "tools/camera_plots.h"
#include "tools/html_page.h"

namespace lsv::cli {
namespace {

using nlohmann::ordered_json;

/// Two figures of the sigma, and the value to the same digit.
std::string plain(const Measured& m) {
  const int decimals =
      m.sigma > 0.0 ? std::max(0, 1 - static_cast<int>(std::floor(std::log10(m.sigma)))) : 6;
  std::string out;
  append_fixed(out, m.value, std::min(decimals, 9));
  out += " +- ";
  append_fixed(out, m.sigma, std::min(decimals, 9));
  return out;
}

Measured times(const Measured& m, double factor) { return {factor * m.value, factor * m.sigma}; }

/// 20 log10, as EMVA 1288 gives ratios.
Measured decibels(const Measured& m) {
  return {20.0 * std::log10(m.value), 20.0 / std::log(10.0) * m.sigma / m.value};
}

struct Row {
  std::string name;
  std::string symbol;
  std::string value;  // with its sigma
  std::string unit;
};

std::vector<Row> rows_of(const CameraCharacterisation& c) {
  const Measured& k = c.transfer.k_counts_per_e;
  const std::string bound = c.saturation_reached ? "" : "at least ";
  std::vector<Row> out = {
      {"system gain", "K", plain(k), "counts/e-"},
      {"", "1/K", plain(Measured{1.0, 0.0} / k), "e-/count"},
      {"dark level", "mu_y.dark", plain(c.mu_dark_counts), "counts"},
      {"dark noise, with rounding", "sigma_y.dark", plain(c.sigma_y_dark_counts), "counts"},
      {"dark noise", "sigma_d", plain(c.dark_noise_e), "e-"},
      {"", "K sigma_d", plain(c.dark_noise_counts), "counts"},
      {"dark nonuniformity", "DSNU1288", plain(c.dsnu_e), "e-"},
      {"", "K DSNU1288", plain(c.dsnu_counts), "counts"},
      {"photo response nonuniformity", "PRNU1288", plain(times(c.prnu_ratio, 100.0)), "%"},
      {"saturation", "mu_y.sat", bound + plain(c.saturation_counts), "counts"},
      {"", "mu_e.sat", bound + plain(c.saturation_e), "e-"},
      {"largest signal / noise", "SNR_max", bound + plain(c.snr_max_ratio), ""},
      {"", "", bound + plain(decibels(c.snr_max_ratio)), "dB"},
      {"dynamic range", "DR", bound + plain(c.dynamic_range_ratio), ""},
      {"", "", bound + plain(decibels(c.dynamic_range_ratio)), "dB"}};
  const bool linear = std::isfinite(c.linearity.error_ratio.value);
  out.push_back({"linearity error", "LE",
                 linear ? plain(times(c.linearity.error_ratio, 100.0)) : "give --exposure-us",
                 linear ? "%" : ""});
  return out;
}

std::string defects_text(const DefectPixels& defects) {
  return formatted("%zu hot, %zu dead; %zu of them stuck", defects.counts.hot, defects.counts.dead,
                   defects.counts.stuck);
}

std::string limits_text(const DefectLimits& limits) {
  return formatted(
      "Defect: dark level more than %.3g counts from the pixels around, noise in the dark above "
      "%.3g counts, or response more than %.3g %% off (%.2f robust standard deviations; on a clean "
      "sensor that makes %.2f false ones).",
      limits.offset_counts, limits.noise_counts, 100.0 * limits.response_ratio, limits.sigmas,
      kFalseDefects);
}

std::string word_of(const LightLevel& level) {
  if (level.saturated) return "saturated";
  return level.used ? "used" : "beyond 70 %";
}

ordered_json to_json(const Measured& m) { return {{"value", m.value}, {"sigma", m.sigma}}; }

ordered_json to_json(const LightLevel& level) {
  return {{"name", level.name},
          {"frames", level.frames},
          {"exposure_us", level.exposure_us},
          {"mean_counts", to_json(level.point.mean_counts)},
          {"variance_counts2", to_json(level.point.variance_counts2)},
          {"flicker_counts", level.flicker_counts},
          {"clipped_share", level.clipped_share},
          {"saturated", level.saturated},
          {"used_for_k", level.used}};
}

std::string cell(const std::string& words) { return "<td>" + escaped(words) + "</td>"; }

std::string figures_table(const CameraCharacterisation& camera) {
  std::string out =
      "<table class=\"figures\"><tr><th>figure</th><th>EMVA 1288</th><th>value +- sigma</th>"
      "<th></th></tr>\n";
  for (const Row& row : rows_of(camera)) {
    std::string value = row.value;
    if (const auto at = value.find("+-"); at != std::string::npos) value.replace(at, 2, "\u00b1");
    out += "<tr>" + cell(row.name) + cell(row.symbol) + cell(value) + cell(row.unit) + "</tr>\n";
  }
  return out + "</table>\n";
}

std::string levels_table(const CameraCharacterisation& camera) {
  std::string out =
      "<table><tr><th>sequence</th><th>frames</th><th>mean, counts</th>"
      "<th>noise, counts\u00b2</th><th>sigma</th><th>flicker, counts</th><th>at full scale, %</th>"
      "<th></th></tr>\n";
  const auto row = [&out](const LightLevel& level, const std::string& clipped,
                          const std::string& word) {
    out += "<tr>" + cell(level.name) +
           cell(formatted("%lld", static_cast<long long>(level.frames))) +
           cell(formatted("%.3f", level.point.mean_counts.value)) +
           cell(formatted("%.4f", level.point.variance_counts2.value)) +
           cell(formatted("%.2g", level.point.variance_counts2.sigma)) +
           cell(formatted("%.3f", level.flicker_counts)) + cell(clipped) + cell(word) + "</tr>\n";
  };
  row(camera.dark, "", "dark");
  for (const LightLevel& level : camera.flats)
    row(level, formatted("%.3f", 100.0 * level.clipped_share), word_of(level));
  return out + "</table>\n";
}

std::string fit_text(const PhotonTransfer& transfer) {
  return formatted("chi2 %.1f for %d degrees of freedom", transfer.chi2, transfer.dof);
}

std::string map_noise_text(const CameraCharacterisation& camera) {
  return formatted("Noise left in the maps: %.3f counts of offset, %.3f %% of gain.",
                   camera.offset_map_noise_counts, 100.0 * camera.gain_map_noise_ratio);
}

}  // namespace

std::string camera_text(const CameraReport& report) {
  const CameraCharacterisation& camera = report.camera;
  std::string out;
  for (const Row& row : rows_of(camera)) {
    out += formatted("%-29s%-13s%s", row.name.c_str(), row.symbol.c_str(), row.value.c_str());
    out += (row.unit.empty() ? "" : " " + row.unit) + "\n";
  }
  out += formatted("%-42s%s\n", "photon transfer", fit_text(camera.transfer).c_str());
  out += formatted("%-42s%s\n", "defect pixels", defects_text(camera.defects).c_str());
  for (const std::string& warning : report.warnings) out += "\nwarning: " + warning + "\n";
  return out;
}

std::string camera_json(const CameraReport& report) {
  const CameraCharacterisation& c = report.camera;
  const CameraRecord& record = *report.calibration.camera;
  ordered_json json = {
      {"schema", "lsv.camera/1"},        {"sensor_name", report.calibration.sensor_name},
      {"width_px", c.format.width_px},   {"height_px", c.format.height_px},
      {"bit_depth", c.format.bit_depth}, {"date", record.date},
      {"method", record.method},         {"inputs_sha256", record.inputs_sha256}};
  json["figures"] = {{"k_counts_per_e", to_json(c.transfer.k_counts_per_e)},
                     {"mu_dark_counts", to_json(c.mu_dark_counts)},
                     {"sigma_y_dark_counts", to_json(c.sigma_y_dark_counts)},
                     {"dark_noise_counts", to_json(c.dark_noise_counts)},
                     {"dark_noise_e", to_json(c.dark_noise_e)},
                     {"dsnu_counts", to_json(c.dsnu_counts)},
                     {"dsnu_e", to_json(c.dsnu_e)},
                     {"prnu_ratio", to_json(c.prnu_ratio)},
                     {"saturation_reached", c.saturation_reached},
                     {"saturation_counts", to_json(c.saturation_counts)},
                     {"saturation_e", to_json(c.saturation_e)},
                     {"snr_max_ratio", to_json(c.snr_max_ratio)},
                     {"dynamic_range_ratio", to_json(c.dynamic_range_ratio)},
                     {"linearity_error_ratio", to_json(c.linearity.error_ratio)}};
  json["photon_transfer"] = {{"chi2", c.transfer.chi2},
                             {"dof", c.transfer.dof},
                             {"sigma_factor", c.transfer.sigma_factor}};
  json["levels"] = ordered_json::array({to_json(c.dark)});
  for (const LightLevel& level : c.flats) json["levels"].push_back(to_json(level));
  const DefectLimits& limits = c.defects.limits;
  json["defects"] = {{"hot", c.defects.counts.hot},
                     {"dead", c.defects.counts.dead},
                     {"stuck", c.defects.counts.stuck},
                     {"limit_sigmas", limits.sigmas},
                     {"limit_offset_counts", limits.offset_counts},
                     {"limit_noise_counts", limits.noise_counts},
                     {"limit_response_ratio", limits.response_ratio}};
  json["maps"] = {{"file", report.calibration.maps->file},
                  {"sha256", report.calibration.maps->sha256},
                  {"gain_from", c.flats[c.gain_level].name},
                  {"prnu_from", c.flats[c.prnu_level].name},
                  {"offset_noise_counts", c.offset_map_noise_counts},
                  {"gain_noise_ratio", c.gain_map_noise_ratio},
                  {"light_range_ratio", c.light_range_ratio}};
  json["warnings"] = report.warnings;
  // File names may hold bytes that are not UTF-8.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string camera_html(const CameraReport& report) {
  const CameraCharacterisation& camera = report.camera;
  const CameraRecord& record = *report.calibration.camera;
  std::string out =
      "<h1>Camera of " + escaped(report.calibration.sensor_name) + "</h1>\n<p class=\"note\">";
  if (!record.date.empty()) out += escaped(record.date) + ", ";
  out += escaped(record.method) +
         formatted(", %d x %d px, %d bit, %d dark frames, %d lit ones at %d levels. ",
                   camera.format.width_px, camera.format.height_px, camera.format.bit_depth,
                   record.dark_frames, record.flat_frames, record.flat_levels) +
         "Inputs " + escaped(record.inputs_sha256.substr(0, 16)) +
         ". Symbols of EMVA 1288, release 4.0, linear model.</p>\n";
  for (const std::string& warning : report.warnings)
    out += "<p class=\"warning\">" + escaped(warning) + "</p>\n";
  out += figures_table(camera);
  out += "<h2>Photon transfer</h2>\n" + photon_transfer_plot(camera) + "<p>" +
         fit_text(camera.transfer) + ".</p>\n" + levels_table(camera);
  if (const std::string plot = linearity_plot(camera); !plot.empty())
    out += "<h2>Linearity</h2>\n" + plot;
  out += "<h2>Fixed pattern</h2>\n" + map_pictures(camera) + "<p>" + map_noise_text(camera) +
         " Gain from " + escaped(camera.flats[camera.gain_level].name) + ", PRNU from " +
         escaped(camera.flats[camera.prnu_level].name) +
         formatted("; its light varies by %.1f %% over the sensor, which is taken out.</p>\n",
                   100.0 * camera.light_range_ratio);
  out += offset_histogram(camera) + gain_histogram(camera);
  out += "<p>" + escaped(limits_text(camera.defects.limits)) +
         " Found: " + escaped(defects_text(camera.defects)) + ".</p>\n";
  return html_page("lsv calibrate camera", out);
}

}  // namespace lsv::cli
