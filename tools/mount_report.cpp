// SPDX-License-Identifier: BSD-3-Clause
#include "tools/mount_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "lsv/output/number_text.h"

namespace lsv::cli {
namespace {

using nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMm = 1e3;
constexpr double kMs = 1e3;

// A ratio that is off has consequences at once; the others are looked at in many places.
constexpr double kRatioWarning_sigmas = 3.0;
constexpr double kWarning_sigmas = 4.0;

double sigma(const MountFit& fit, std::size_t figure) { return std::sqrt(fit.cov[figure][figure]); }

double seconds(const MountFit& fit, Stamp stamp) {
  return seconds_between(fit.residuals.front().stamp, stamp);
}

void add_fit_warnings(const MountedSensor& sensor, std::vector<std::string>& out) {
  const MountFit& fit = sensor.fit;
  const std::string name = sensor_label(sensor) + ": ";
  if (fit.sigma_factor > 1.0) {
    out.push_back(name +
                  formatted("the residuals are %.2f times what the sigmas allow, and all "
                            "sigmas were raised by that",
                            fit.sigma_factor) +
                  (sensor.fits_scale ? "" : "; if the scale is in doubt, try --fit-scale"));
  }
  const DriveCheck& check = sensor.check;
  const double scale_sigmas = std::abs(check.scale_ratio - 1.0) / check.sigma_scale_ratio;
  if (scale_sigmas > kWarning_sigmas) {
    out.push_back(name + formatted("against the reference the track reads %+.3f %% (%.0f sigma); "
                                   "lsv calibrate scale mends the scale",
                                   100.0 * (1.0 / check.scale_ratio - 1.0), scale_sigmas));
  }
  if (!sensor.fits_clock &&
      std::abs(check.clock_offset_s) > kWarning_sigmas * check.sigma_clock_offset_s) {
    out.push_back(name + formatted("its clock is ahead of that of the reference by %+.2f +- %.2f "
                                   "ms; --fit-clock takes it into account",
                                   -kMs * check.clock_offset_s, kMs * check.sigma_clock_offset_s));
  }
  const auto worst =
      std::ranges::max_element(sensor.stretches, {}, [](const MountStretch& stretch) {
        return std::isfinite(stretch.misfit_sigmas) ? stretch.misfit_sigmas : 0.0;
      });
  if (worst != sensor.stretches.end() && worst->misfit_sigmas > kWarning_sigmas) {
    out.push_back(name + formatted("the drive from %.1f to %.1f s contradicts the rest by %.1f "
                                   "sigma",
                                   seconds(fit, worst->begin), seconds(fit, worst->end),
                                   worst->misfit_sigmas));
  }
  constexpr double kBackwards_rad = 0.75 * std::numbers::pi;
  if (std::abs(fit.yaw_rad) > kBackwards_rad) {
    out.push_back(name +
                  "its x axis points backwards: right if it is mounted so; otherwise its "
                  "calibration counts the travel of the ground and not of the vehicle");
  }
}

ordered_json known(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json sensor_json(const MountedSensor& sensor) {
  const MountFit& fit = sensor.fit;
  ordered_json out = {{"name", sensor.calibration.sensor_name},
                      {"track", sensor.track_file},
                      {"track_sha256", sensor.track_sha256},
                      {"calibration", sensor.calibration_file},
                      {"output", sensor.output_file},
                      {"x_m", fit.x_m},
                      {"y_m", fit.y_m},
                      {"yaw_rad", fit.yaw_rad},
                      {"sigma_x_m", sigma(fit, 0)},
                      {"sigma_y_m", sigma(fit, 1)},
                      {"sigma_yaw_rad", sigma(fit, 2)},
                      {"cov_xy_m2", fit.cov[0][1]},
                      {"cov_x_yaw_m_rad", fit.cov[0][2]},
                      {"cov_y_yaw_m_rad", fit.cov[1][2]}};
  out["scale_ratio"] = known(sensor.check.scale_ratio);
  out["sigma_scale_ratio"] = known(sensor.check.sigma_scale_ratio);
  out["scale_ratio_applied"] = sensor.fits_scale;
  out["clock_offset_s"] = known(sensor.check.clock_offset_s);
  out["sigma_clock_offset_s"] = known(sensor.check.sigma_clock_offset_s);
  out["clock_offset_applied"] = sensor.fits_clock;
  out["mirrored"] = nullptr;
  if (sensor.mirrored)
    out["mirrored"] = {{"x_m", sensor.mirrored->x_m},
                       {"y_m", sensor.mirrored->y_m},
                       {"yaw_rad", sensor.mirrored->yaw_rad}};
  out["chi2"] = fit.chi2;
  out["dof"] = fit.dof;
  out["sigma_factor"] = fit.sigma_factor;
  out["travel_m"] = fit.travel_m;
  out["turn_rad"] = fit.turn_rad;
  out["poses_used"] = fit.poses;
  out["poses_left_out"] = fit.outliers;
  out["gaps"] = fit.gaps;
  out["shifts_ok"] = sensor.accepted;
  out["shifts_rejected"] = sensor.refused;
  out["stretches"] = ordered_json::array();
  for (const MountStretch& stretch : sensor.stretches) {
    out["stretches"].push_back({{"begin_s", seconds(fit, stretch.begin)},
                                {"end_s", seconds(fit, stretch.end)},
                                {"misfit_sigmas", known(stretch.misfit_sigmas)},
                                {"change_x_m", known(stretch.change_x_m)},
                                {"change_y_m", known(stretch.change_y_m)},
                                {"change_yaw_rad", known(stretch.change_yaw_rad)}});
  }
  return out;
}

ordered_json pair_json(const MountPair& pair) {
  return {{"first", pair.first},
          {"second", pair.second},
          {"reads_ratio", pair.ratio.ratio},
          {"sigma_reads_ratio", pair.ratio.sigma_ratio},
          {"yaw_rad", pair.ratio.yaw_rad},
          {"sigma_yaw_rad", pair.ratio.sigma_yaw_rad},
          {"clock_offset_s", pair.ratio.clock_offset_s},
          {"sigma_clock_offset_s", pair.ratio.sigma_clock_offset_s},
          {"rig_sigma_m", pair.ratio.rig_sigma_m},
          {"false_yaw_rad_per_m", known(pair.false_yaw_rad_per_m)},
          {"false_yaw_deg_per_h_at_42_mm_s", known(false_yaw_deg_per_h(pair))},
          {"corrected", pair.is_corrected},
          {"chi2", pair.ratio.chi2},
          {"dof", pair.ratio.dof},
          {"sigma_factor", pair.ratio.sigma_factor}};
}

std::string scale_line(const MountedSensor& sensor) {
  const DriveCheck& check = sensor.check;
  if (!std::isfinite(check.sigma_scale_ratio))
    return "  scale      this drive does not tell whether it is right\n";
  return formatted("  scale      %10.6f +- %.6f: true travel / travel of the track%s\n",
                   check.scale_ratio, check.sigma_scale_ratio,
                   sensor.fits_scale ? "" : ", not applied");
}

std::string clock_line(const MountedSensor& sensor) {
  const DriveCheck& check = sensor.check;
  if (!std::isfinite(check.sigma_clock_offset_s))
    return "  clock      this drive does not tell whether it agrees\n";
  return formatted("  clock      %+10.3f +- %.3f ms to add to the track%s\n",
                   kMs * check.clock_offset_s, kMs * check.sigma_clock_offset_s,
                   sensor.fits_clock ? "" : ", not applied");
}

}  // namespace

std::string sensor_label(const MountedSensor& sensor) {
  return std::filesystem::path(sensor.output_file).stem().string();
}

double false_yaw_deg_per_h(const MountPair& pair) {
  constexpr double kSPerH = 3600.0;
  return pair.false_yaw_rad_per_m * kRoverSpeed_m_s * kDegrees * kSPerH;
}

std::string mirror_note(const MountedSensor& sensor) {
  return formatted(
      "a mirrored sensor at x %+.1f mm, yaw %+.2f deg would fit as well: look which "
      "it is",
      kMm * sensor.mirrored->x_m, kDegrees * sensor.mirrored->yaw_rad);
}

std::vector<std::string> mount_warnings(const MountReport& report) {
  std::vector<std::string> out;
  for (const MountedSensor& sensor : report.sensors) add_fit_warnings(sensor, out);
  for (const MountPair& pair : report.pairs) {
    const double off = pair.ratio.ratio - 1.0;
    if (pair.is_corrected || std::abs(off) <= kRatioWarning_sigmas * pair.ratio.sigma_ratio)
      continue;
    const std::string first = sensor_label(report.sensors[pair.first]);
    std::string line = sensor_label(report.sensors[pair.second]);
    line += formatted(" reads %+.4f %% against %s (%.0f sigma): ", 100.0 * off, first.c_str(),
                      std::abs(off) / pair.ratio.sigma_ratio);
    line += formatted(
        "false yaw of %+.3g deg/h at 42 mm/s; --correct-ratio writes a calibration "
        "that agrees with %s",
        false_yaw_deg_per_h(pair), first.c_str());
    out.push_back(line);
  }
  return out;
}

std::string mount_text(const MountReport& report) {
  std::string out;
  for (const MountedSensor& sensor : report.sensors) {
    const MountFit& fit = sensor.fit;
    out += sensor_label(sensor) + "\n";
    out += formatted("  x forward  %+10.2f +- %.2f mm\n", kMm * fit.x_m, kMm * sigma(fit, 0));
    out += formatted("  y left     %+10.2f +- %.2f mm\n", kMm * fit.y_m, kMm * sigma(fit, 1));
    out += formatted("  yaw        %+10.4f +- %.4f deg\n", kDegrees * fit.yaw_rad,
                     kDegrees * sigma(fit, 2));
    if (sensor.mirrored) out += "  mirrored   " + mirror_note(sensor) + "\n";
    out += scale_line(sensor) + clock_line(sensor);
    out += formatted("  fit        chi2 %.0f for %d degrees of freedom, %.3g m, %.3g deg turned\n",
                     fit.chi2, fit.dof, fit.travel_m, kDegrees * fit.turn_rad);
    out += formatted("  used       %zu poses, %zu left out, %zu gaps; %zu shifts, %zu refused\n",
                     fit.poses, fit.outliers, fit.gaps, sensor.accepted, sensor.refused);
  }
  for (const MountPair& pair : report.pairs) {
    out += sensor_label(report.sensors[pair.second]) + " against " +
           sensor_label(report.sensors[pair.first]) + (pair.is_corrected ? ", corrected\n" : "\n");
    out += formatted("  reads      %10.6f +- %.6f of its travel\n", pair.ratio.ratio,
                     pair.ratio.sigma_ratio);
    out += formatted("  yaw        %+10.5f +- %.5f deg\n", kDegrees * pair.ratio.yaw_rad,
                     kDegrees * pair.ratio.sigma_yaw_rad);
    if (std::isfinite(pair.false_yaw_rad_per_m))
      out += formatted("  false yaw  %+10.3g mrad/m straight ahead, %+.3g deg/h at 42 mm/s\n",
                       1e3 * pair.false_yaw_rad_per_m, false_yaw_deg_per_h(pair));
  }
  for (const std::string& warning : mount_warnings(report)) out += "\nwarning: " + warning + "\n";
  return out;
}

std::string mount_json(const MountReport& report) {
  ordered_json out = {{"schema", "lsv.mount/1"},
                      {"reference", report.reference_file},
                      {"reference_sha256", report.reference_sha256},
                      {"sensors", ordered_json::array()},
                      {"pairs", ordered_json::array()}};
  for (const MountedSensor& sensor : report.sensors) out["sensors"].push_back(sensor_json(sensor));
  for (const MountPair& pair : report.pairs) out["pairs"].push_back(pair_json(pair));
  out["warnings"] = mount_warnings(report);
  return out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace lsv::cli
