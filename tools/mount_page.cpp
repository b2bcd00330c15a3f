// SPDX-License-Identifier: BSD-3-Clause
#include "tools/mount_page.h"

#include <cmath>
#include <initializer_list>
#include <numbers>

#include "lsv/output/number_text.h"
#include "lsv/output/svg.h"
#include "tools/html_page.h"
#include "tools/mount_drawing.h"

namespace lsv::cli {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMm = 1e3;

std::string cells(const char* tag, std::initializer_list<std::string> words) {
  std::string out = "<tr>";
  for (const std::string& word : words)
    out += std::string("<") + tag + ">" + escaped(word) + "</" + tag + ">";
  return out + "</tr>\n";
}

std::string figure(double value, double sigma, int decimals) {
  return formatted("%+.*f", decimals, value) + " ± " + formatted("%.*f", decimals, sigma);
}

std::string known(double value, int decimals) {
  return std::isfinite(value) ? formatted("%+.*f", decimals, value) : std::string("unknown");
}

std::string sensors_table(const MountReport& report) {
  std::string out = "<table>" + cells("th", {"sensor", "x forward, mm", "y left, mm", "yaw, deg"});
  for (const MountedSensor& sensor : report.sensors) {
    const MountFit& fit = sensor.fit;
    const auto sigma = [&fit](std::size_t i) { return std::sqrt(fit.cov[i][i]); };
    out += cells("td", {sensor_label(sensor), figure(kMm * fit.x_m, kMm * sigma(0), 2),
                        figure(kMm * fit.y_m, kMm * sigma(1), 2),
                        figure(kDegrees * fit.yaw_rad, kDegrees * sigma(2), 4)});
  }
  return out +
         "</table>\n<p class=\"note\">Body frame: x forward, y left, z up. Yaw: direction of the x "
         "axis of the sensor, counter-clockwise. One standard deviation each.</p>\n";
}

std::string checks_table(const MountReport& report) {
  std::string out = "<h2>Clock and scale, as the drive tells them</h2>\n<table>" +
                    cells("th", {"sensor", "to add to its times, ms", "",
                                 "true travel / travel of the track", ""});
  const auto applied = [](bool is_applied) {
    return std::string(is_applied ? "applied" : "not applied");
  };
  for (const MountedSensor& sensor : report.sensors) {
    const DriveCheck& check = sensor.check;
    const bool has_clock = std::isfinite(check.sigma_clock_offset_s);
    const bool has_scale = std::isfinite(check.sigma_scale_ratio);
    out += cells(
        "td", {sensor_label(sensor),
               has_clock ? figure(kMm * check.clock_offset_s, kMm * check.sigma_clock_offset_s, 2)
                         : std::string("not told"),
               has_clock ? applied(sensor.fits_clock) : std::string(),
               has_scale ? formatted("%.6f ± %.6f", check.scale_ratio, check.sigma_scale_ratio)
                         : std::string("not told"),
               has_scale ? applied(sensor.fits_scale) : std::string()});
  }
  return out + "</table>\n";
}

std::string pairs_table(const MountReport& report) {
  if (report.pairs.empty()) return {};
  std::string out = "<h2>Scales against each other</h2>\n<table>" +
                    cells("th", {"pair", "reads", "yaw between, deg", "false yaw, mrad/m",
                                 "at 42 mm/s, deg/h", ""});
  for (const MountPair& pair : report.pairs) {
    const bool apart = std::isfinite(pair.false_yaw_rad_per_m);
    out += cells(
        "td",
        {sensor_label(report.sensors[pair.second]) + " / " +
             sensor_label(report.sensors[pair.first]),
         formatted("%.6f ± %.6f", pair.ratio.ratio, pair.ratio.sigma_ratio),
         figure(kDegrees * pair.ratio.yaw_rad, kDegrees * pair.ratio.sigma_yaw_rad, 5),
         apart ? formatted("%+.3g", 1e3 * pair.false_yaw_rad_per_m) : std::string("one place"),
         apart ? formatted("%+.3g", false_yaw_deg_per_h(pair)) : std::string(),
         pair.is_corrected ? std::string("corrected") : std::string()});
  }
  return out +
         "</table>\n<p class=\"note\">Reads: travel that the first named sensor reads for a travel "
         "of 1 on the other, whatever the true scale is. False yaw: what the pair sees as turning "
         "while the body drives straight ahead, positive to the left.</p>\n";
}

std::string stretches_table(const MountedSensor& sensor) {
  std::string out = "<table>" + cells("th", {"stretch, s", "contradicts the rest by, sigma",
                                             "without it x, mm", "y, mm", "yaw, deg"});
  const Stamp first = sensor.fit.residuals.front().stamp;
  for (const MountStretch& s : sensor.stretches) {
    out += cells("td", {formatted("%.1f to %.1f", seconds_between(first, s.begin),
                                  seconds_between(first, s.end)),
                        known(s.misfit_sigmas, 1), known(kMm * s.change_x_m, 2),
                        known(kMm * s.change_y_m, 2), known(kDegrees * s.change_yaw_rad, 4)});
  }
  return out + "</table>\n";
}

std::string sensor_section(const MountedSensor& sensor) {
  const MountFit& fit = sensor.fit;
  std::string out = "<h2>" + escaped(sensor_label(sensor)) + "</h2>\n<p>" +
                    escaped(sensor.calibration.sensor_name) + ". Track " +
                    escaped(sensor.track_file) + ", SHA-256 " +
                    escaped(sensor.track_sha256.substr(0, 16)) +
                    formatted(
                        ": %zu shifts accepted, %zu refused. %zu reference poses used, %zu "
                        "left out, %zu gaps. %.3g m driven, headings over %.3g deg. chi2 "
                        "%.0f for %d degrees of freedom.</p>\n",
                        sensor.accepted, sensor.refused, fit.poses, fit.outliers, fit.gaps,
                        fit.travel_m, kDegrees * fit.turn_rad, fit.chi2, fit.dof);
  if (sensor.mirrored) out += "<p>Note: " + escaped(mirror_note(sensor)) + ".</p>\n";
  out += "<figure>" + residuals_svg(fit) + "</figure>\n" + stretches_table(sensor);
  return out;
}

}  // namespace

std::string mount_html(const MountReport& report) {
  std::string out = "<h1>Mount of the sensors</h1>\n<p>Reference " +
                    escaped(report.reference_file) + ", SHA-256 " +
                    escaped(report.reference_sha256.substr(0, 16)) + ".</p>\n";
  for (const std::string& warning : mount_warnings(report))
    out += "<p class=\"warning\">" + escaped(warning) + "</p>\n";
  out += sensors_table(report) + "<figure>" + vehicle_svg(report) + "</figure>\n" +
         pairs_table(report) + checks_table(report);
  for (const MountedSensor& sensor : report.sensors) out += sensor_section(sensor);
  return html_page("lsv calibrate mount", out);
}

}  // namespace lsv::cli
