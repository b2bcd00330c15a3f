// SPDX-License-Identifier: BSD-3-Clause
#include "tools/geometry_report.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

namespace lsv::cli {
namespace {

using nlohmann::ordered_json;

constexpr double kRad_per_deg = 3.14159265358979323846 / 180.0;
constexpr double kMm = 1e3;  // mm per m, mm/s per m/s
constexpr double kUm = 1e6;
constexpr double kPercent = 100.0;
constexpr double kRounding = 1e-12;  // relative

std::string text_of_list(const char* format, va_list values) {
  char line[256];
  std::vsnprintf(line, sizeof line, format, values);
  return line;
}

[[gnu::format(printf, 1, 2)]] std::string text_of(const char* format, ...) {
  va_list values;
  va_start(values, format);
  std::string out = text_of_list(format, values);
  va_end(values);
  return out;
}

[[gnu::format(printf, 2, 3)]] void append(std::string& out, const char* format, ...) {
  va_list values;
  va_start(values, format);
  out += text_of_list(format, values);
  va_end(values);
}

bool known(double value) { return !std::isnan(value); }

// ---- predictions -----------------------------------------------------------------------------

double speckle_m(const GeometryInput& in) {
  if (in.imaged()) return imaged_speckle_m(in.wavelength_m, in.magnification_ratio, in.f_number);
  return objective_speckle_m(in.wavelength_m, in.distances.sensor_distance_m, in.spot_diameter_m);
}

/// What would make the speckles `times` as large.
std::string cure(const GeometryInput& in, double times) {
  if (in.imaged()) return text_of("close the aperture to F/%.3g", in.f_number * times);
  return text_of("make the spot %.3g mm", in.spot_diameter_m * kMm / times);
}

void add_warnings(GeometryReport& r) {
  if (r.speckle_px < kAliasedSpeckle_px) {
    r.warnings.push_back(
        text_of("speckle of %.3g px aliases (under %.0f px): ", r.speckle_px, kAliasedSpeckle_px) +
        cure(r.input, kGoodSpeckle_px / r.speckle_px) + text_of(" for %.0f px", kGoodSpeckle_px));
  } else if (r.speckle_px < kGoodSpeckle_px) {
    r.warnings.push_back(text_of("speckle of %.3g px is small: ", r.speckle_px) +
                         cure(r.input, kGoodSpeckle_px / r.speckle_px) +
                         text_of(" for the recommended %.0f px", kGoodSpeckle_px));
  }
  const double limit_m_s = std::fmin(r.largest_speed_x_m_s, r.largest_speed_y_m_s);
  if (r.input.speed_m_s > limit_m_s) {
    r.warnings.push_back(text_of("%.4g mm/s is beyond the range of this window and rate, %.4g mm/s",
                                 r.input.speed_m_s * kMm, limit_m_s * kMm));
  }
}

// ---- text ------------------------------------------------------------------------------------

/// An option and whether it was given.
using Need = std::pair<const char*, double>;

/// "give --a, --b" for those that are missing; empty when none is.
std::string missing(std::initializer_list<Need> needs) {
  std::string out;
  for (const auto& [option, value] : needs) {
    if (!known(value)) out += (out.empty() ? "give " : ", ") + std::string(option);
  }
  return out;
}

/// The name of a line of the report, or the reason why there is nothing more to it.
bool begin(std::string& out, const char* name, const std::string& lacks = "") {
  append(out, "%-11s", name);
  if (lacks.empty()) return true;
  out += lacks + "\n";
  return false;
}

constexpr const char* kIndent = "           ";

void append_optics(std::string& out, const GeometryReport& r) {
  const GeometryInput& in = r.input;
  begin(out, "optics");
  if (in.imaged()) {
    append(out, "imaged speckle: camera focused on the surface, magnification %.6g",
           in.magnification_ratio);
    if (known(in.f_number)) append(out, ", F/%.4g", in.f_number);
    out += '\n';
    if (known(r.object_distance_m)) {
      append(out, "%sfocal length %.5g mm: surface %.5g mm from the lens\n", kIndent,
             in.focal_length_m * kMm, r.object_distance_m * kMm);
    }
    if (in.collimated()) append(out, "%scollimated light\n", kIndent);
    if (std::isfinite(in.distances.source_distance_m))
      append(out, "%svirtual source %.5g mm from the surface\n", kIndent,
             in.distances.source_distance_m * kMm);
    return;
  }
  out += "objective speckle: no lens, source and sensor on the normal of the surface\n";
  append(out, "%ssensor %.5g mm from the surface, ", kIndent, in.distances.sensor_distance_m * kMm);
  if (in.collimated())
    out += "collimated light\n";
  else
    append(out, "virtual source %.5g mm\n", in.distances.source_distance_m * kMm);
}

void append_scale(std::string& out, const GeometryReport& r) {
  begin(out, "scale");
  append(out, "Sc %.5f: pattern shift on the sensor / surface travel\n", r.scale.sc_ratio);
  if (known(r.scale.pixel_pitch_m))
    append(out, "%s1 px is %.5g um of travel\n", kIndent, surface_m_per_px(r.scale) * kUm);
}

void append_slope(std::string& out, const char* name, double slope_per_m, double sc) {
  append(out, "  %-30s %+10.5f %+10.4f %%\n", name, slope_per_m / kMm,
         slope_per_m / sc / kMm * kPercent);
}

void append_slopes(std::string& out, const GeometryReport& r) {
  const double sc = r.scale.sc_ratio;
  if (!r.input.imaged()) {
    append(out, "\n  %-30s %10s %12s\n", "a distance grows by 1 mm", "Sc", "of Sc");
    append_slope(out, "source alone", r.slopes.source_per_m, sc);
    append_slope(out, "sensor alone", r.slopes.sensor_per_m, sc);
    append_slope(out, "both: height of the sensor", r.slopes.height_per_m, sc);
    out += '\n';
    return;
  }
  if (!known(r.fixed_focus_slope_per_m) && !known(r.refocused_slope_per_m)) {
    begin(out, "height", "give --source-distance-m or --collimated, and --focal-mm");
    return;
  }
  append(out, "\n  %-30s %10s %12s\n", "1 mm higher", "Sc", "of Sc");
  if (known(r.fixed_focus_slope_per_m))
    append_slope(out, "focus left as it is", r.fixed_focus_slope_per_m * sc, sc);
  if (known(r.refocused_slope_per_m))
    append_slope(out, "focused again, simple lens", r.refocused_slope_per_m * sc, sc);
  out += '\n';
}

void append_tilt(std::string& out, const GeometryReport& r) {
  begin(out, "tilt");
  if (r.input.imaged()) {
    append(out, "none at focus; 1 deg/s reads as %.4g mm/s of travel for each mm out of focus\n",
           imaged_tilt_travel_m_per_rad(1e-3) * kRad_per_deg * kMm);
    return;
  }
  append(out, "1 deg/s moves the pattern by %.4g mm/s and reads as %.4g mm/s of travel\n",
         r.tilt_shift_m_per_rad * kRad_per_deg * kMm, r.tilt_travel_m_per_rad * kRad_per_deg * kMm);
}

void append_speckle(std::string& out, const GeometryReport& r) {
  const GeometryInput& in = r.input;
  const std::string lacks =
      in.imaged()
          ? missing({{"--wavelength-nm", in.wavelength_m}, {"--f-number", in.f_number}})
          : missing({{"--wavelength-nm", in.wavelength_m}, {"--spot-mm", in.spot_diameter_m}});
  if (!begin(out, "speckle", lacks)) return;
  append(out, "%.4g um", r.speckle_m * kUm);
  if (known(r.speckle_px)) append(out, ", %.3g px", r.speckle_px);
  out += in.imaged() ? ": wavelength (1 + M) F#\n" : ": wavelength x distance / spot diameter\n";
}

void append_range(std::string& out, const GeometryReport& r) {
  const GeometryInput& in = r.input;
  const std::string lacks = missing(
      {{"--pixel-um", in.pixel_pitch_m}, {"--size", in.width_px}, {"--rate-hz", in.rate_hz}});
  if (!begin(out, "range", lacks)) return;
  append(out, "up to %.4g mm/s along x, %.4g mm/s along y: a quarter of the window per frame\n",
         r.largest_speed_x_m_s * kMm, r.largest_speed_y_m_s * kMm);
  append(out, "%s%.0f x %.0f px at %.6g Hz; ", kIndent, in.width_px, in.height_px, in.rate_hz);
  append(out,
         in.imaged() ? "field of view %.4g x %.4g mm\n"
                     : "%.4g x %.4g mm of travel cross the window\n",
         window_on_ground_m(r.scale, in.width_px) * kMm,
         window_on_ground_m(r.scale, in.height_px) * kMm);
}

void append_noise(std::string& out, const GeometryReport& r) {
  if (!begin(out, "noise",
             missing({{"--pixel-um", r.input.pixel_pitch_m}, {"--rate-hz", r.input.rate_hz}})))
    return;
  append(out, "%.4g px per frame is %.4g mm/s\n", r.input.sigma_px, r.velocity_sigma_m_s * kMm);
}

void append_speed(std::string& out, const GeometryReport& r) {
  const GeometryInput& in = r.input;
  if (!known(in.speed_m_s)) return;
  if (!begin(out, "speed", missing({{"--pixel-um", in.pixel_pitch_m}, {"--rate-hz", in.rate_hz}})))
    return;
  append(out, "%.5g mm/s is %.4g px per frame", in.speed_m_s * kMm, r.speed_px);
  if (known(r.tilt_travel_m_per_rad)) {
    append(out, "; 1 deg/s of tilt is %.3g %% of it",
           r.tilt_travel_m_per_rad * kRad_per_deg / in.speed_m_s * kPercent);
  }
  out += '\n';
}

std::string length_text(double m) {
  return std::isinf(m) ? std::string("infinity") : text_of("%.5g mm", m * kMm);
}

void append_change(std::string& out, const char* name, const DistanceChange& change,
                   double assumed_m) {
  append(out, "%s%-9sat %s", kIndent, name, length_text(change.distance_m).c_str());
  if (std::isfinite(change.sigma_m)) append(out, " +- %.2g mm", change.sigma_m * kMm);
  append(out, ", not %s", length_text(assumed_m).c_str());
  if (std::isfinite(change.change_m)) append(out, ": %+.4g mm", change.change_m * kMm);
  out += '\n';
}

void append_cannot(std::string& out, const char* name, const char* reason) {
  append(out, "%s%-9scannot explain it: %s\n", kIndent, name, reason);
}

const char* why_no_height(const GeometryReport& r) {
  const ObjectiveGeometry& g = r.input.distances;
  if (r.input.collimated()) return "collimated light moves by 1 at every height";
  if (r.input.measured_sc_ratio <= 1.0) return "Sc stays above 1 at every height";
  if (g.source_distance_m == g.sensor_distance_m)
    return "source and sensor at one height give 2 at every height";
  return "a common height never carries Sc across 2";
}

void append_incidence(std::string& out, const GeometryReport& r) {
  if (!r.explanation.incidence) {
    append_cannot(out, "beam",
                  r.input.collimated() ? "collimated light moves by 1 at every angle"
                                       : "off the normal it lowers Sc, and never below 1");
    return;
  }
  const AngleChange& beam = *r.explanation.incidence;
  append(out, "%s%-9s%.2f deg", kIndent, "beam", beam.angle_rad / kRad_per_deg);
  if (std::isfinite(beam.sigma_rad)) append(out, " +- %.2g deg", beam.sigma_rad / kRad_per_deg);
  append(out, " off the normal in the plane of this axis; the other axis keeps %.5f\n",
         r.scale.sc_ratio);
}

void append_objective_reasons(std::string& out, const GeometryReport& r) {
  const ObjectiveGeometry& g = r.input.distances;
  append(out, "%sEach of these alone would explain it:\n", kIndent);
  if (r.explanation.source)
    append_change(out, "source", *r.explanation.source, g.source_distance_m);
  else
    append_cannot(out, "source", "an Sc under 1 needs a beam that converges");
  if (r.explanation.sensor)
    append_change(out, "sensor", *r.explanation.sensor, g.sensor_distance_m);
  else
    append_cannot(out, "sensor",
                  r.input.collimated() ? "collimated light moves by 1 at every distance"
                                       : "Sc stays above 1 at every distance");
  if (r.explanation.height) {
    append(out, "%s%-9ssource and sensor both %+.4g mm", kIndent, "height",
           r.explanation.height->change_m * kMm);
    if (std::isfinite(r.explanation.height->sigma_m))
      append(out, " +- %.2g mm", r.explanation.height->sigma_m * kMm);
    out += '\n';
  } else {
    append_cannot(out, "height", why_no_height(r));
  }
  append_incidence(out, r);
}

void append_imaged_reasons(std::string& out, const GeometryReport& r) {
  if (known(r.defocus_m)) {
    append(out, "%sThe surface %.4g mm %s the plane of focus", kIndent, std::abs(r.defocus_m) * kMm,
           r.defocus_m < 0.0 ? "nearer than" : "beyond");
    if (known(r.defocus_sigma_m)) append(out, ", +- %.2g mm,", r.defocus_sigma_m * kMm);
    append(out, "\n%swould explain it; so would another magnification.\n", kIndent);
  } else if (r.input.collimated()) {
    append(out, "%sFocus cannot explain it in collimated light: the magnification is another.\n",
           kIndent);
  }
}

void append_measured(std::string& out, const GeometryReport& r) {
  const GeometryInput& in = r.input;
  if (!known(in.measured_sc_ratio)) return;
  const double difference = r.explanation.difference_ratio;
  append(out, "\nmeasured   Sc %.5f", in.measured_sc_ratio);
  if (known(in.measured_sc_sigma_ratio)) append(out, " +- %.5f", in.measured_sc_sigma_ratio);
  append(out, ": %+.3f %% from the prediction", difference / r.scale.sc_ratio * kPercent);
  if (in.measured_sc_sigma_ratio > 0.0)
    append(out, ", %.3g sigma", std::abs(difference) / in.measured_sc_sigma_ratio);
  out += '\n';
  if (std::abs(difference) <= kRounding * r.scale.sc_ratio) return;
  if (std::abs(difference) <= 2.0 * in.measured_sc_sigma_ratio) {
    append(out, "%sThey agree within 2 sigma.\n", kIndent);
    return;
  }
  if (in.imaged())
    append_imaged_reasons(out, r);
  else
    append_objective_reasons(out, r);
}

// ---- JSON ------------------------------------------------------------------------------------

ordered_json to_json(const std::optional<DistanceChange>& change) {
  if (!change) return nullptr;
  return {{"distance_m", change->distance_m},
          {"change_m", change->change_m},
          {"sigma_m", change->sigma_m}};
}

ordered_json to_json(const std::optional<AngleChange>& change) {
  if (!change) return nullptr;
  return {{"angle_rad", change->angle_rad}, {"sigma_rad", change->sigma_rad}};
}

ordered_json input_json(const GeometryInput& in) {
  return {{"model", in.imaged() ? "imaged" : "objective"},
          {"collimated", in.collimated()},
          {"source_distance_m", in.distances.source_distance_m},
          {"sensor_distance_m", in.distances.sensor_distance_m},
          {"magnification_ratio", in.magnification_ratio},
          {"f_number", in.f_number},
          {"focal_length_m", in.focal_length_m},
          {"wavelength_m", in.wavelength_m},
          {"spot_diameter_m", in.spot_diameter_m},
          {"pixel_pitch_m", in.pixel_pitch_m},
          {"rate_hz", in.rate_hz},
          {"width_px", in.width_px},
          {"height_px", in.height_px}};
}

ordered_json scale_json(const GeometryReport& r) {
  ordered_json out = {{"sc_ratio", r.scale.sc_ratio},
                      {"surface_m_per_px", surface_m_per_px(r.scale)}};
  if (r.input.imaged()) {
    out["object_distance_m"] = r.object_distance_m;
    out["relative_slope_height_fixed_focus_per_m"] = r.fixed_focus_slope_per_m;
    out["relative_slope_height_refocused_per_m"] = r.refocused_slope_per_m;
  } else {
    out["sc_slope_source_per_m"] = r.slopes.source_per_m;
    out["sc_slope_sensor_per_m"] = r.slopes.sensor_per_m;
    out["sc_slope_height_per_m"] = r.slopes.height_per_m;
    out["tilt_pattern_m_s_per_rad_s"] = r.tilt_shift_m_per_rad;
    out["tilt_travel_m_s_per_rad_s"] = r.tilt_travel_m_per_rad;
  }
  return out;
}

ordered_json measured_json(const GeometryReport& r) {
  ordered_json out = {{"sc_ratio", r.input.measured_sc_ratio},
                      {"sc_sigma_ratio", r.input.measured_sc_sigma_ratio},
                      {"sc_difference_ratio", r.explanation.difference_ratio}};
  if (r.input.imaged()) {
    out["explained_by"] = {
        {"defocus", {{"defocus_m", r.defocus_m}, {"sigma_m", r.defocus_sigma_m}}}};
  } else {
    out["explained_by"] = {{"source", to_json(r.explanation.source)},
                           {"sensor", to_json(r.explanation.sensor)},
                           {"height", to_json(r.explanation.height)},
                           {"incidence", to_json(r.explanation.incidence)}};
  }
  return out;
}

}  // namespace

bool GeometryInput::imaged() const { return known(magnification_ratio); }

bool GeometryInput::collimated() const { return std::isinf(distances.source_distance_m); }

GeometryReport predict(const GeometryInput& in) {
  GeometryReport r;
  r.input = in;
  r.scale = {.sc_ratio = in.imaged() ? in.magnification_ratio : predicted_sc(in.distances),
             .pixel_pitch_m = in.pixel_pitch_m,
             .rate_hz = in.rate_hz};
  if (in.imaged()) {
    r.fixed_focus_slope_per_m = fixed_focus_slope_per_m(in.distances.source_distance_m);
    r.refocused_slope_per_m = refocused_slope_per_m(in.focal_length_m, in.magnification_ratio);
    r.object_distance_m = object_distance_m(in.focal_length_m, in.magnification_ratio);
    r.explanation.difference_ratio = in.measured_sc_ratio - in.magnification_ratio;
    r.defocus_m = defocus_for_sc_m(in.distances.source_distance_m, in.magnification_ratio,
                                   in.measured_sc_ratio);
    r.defocus_sigma_m =
        in.distances.source_distance_m / in.magnification_ratio * in.measured_sc_sigma_ratio;
  } else {
    r.slopes = sc_slopes(in.distances);
    r.tilt_shift_m_per_rad = tilt_shift_m_per_rad(in.distances);
    r.tilt_travel_m_per_rad = tilt_travel_m_per_rad(in.distances);
    r.explanation = explain_sc(in.distances, in.measured_sc_ratio, in.measured_sc_sigma_ratio);
  }
  r.speckle_m = speckle_m(in);
  r.speckle_px = r.speckle_m / in.pixel_pitch_m;
  r.speed_px = shift_px_per_frame(r.scale, in.speed_m_s);
  r.largest_speed_x_m_s = largest_speed_m_s(r.scale, in.width_px);
  r.largest_speed_y_m_s = largest_speed_m_s(r.scale, in.height_px);
  r.velocity_sigma_m_s = velocity_sigma_m_s(r.scale, in.sigma_px);
  add_warnings(r);
  return r;
}

std::string geometry_text(const GeometryReport& report) {
  std::string out;
  append_optics(out, report);
  append_scale(out, report);
  append_slopes(out, report);
  append_tilt(out, report);
  append_speckle(out, report);
  append_range(out, report);
  append_noise(out, report);
  append_speed(out, report);
  append_measured(out, report);
  if (!report.warnings.empty()) out += '\n';
  for (const std::string& warning : report.warnings) out += "warning: " + warning + "\n";
  return out;
}

std::string geometry_json(const GeometryReport& r) {
  ordered_json json = {{"schema", "lsv.geometry/1"}, {"input", input_json(r.input)}};
  json["scale"] = scale_json(r);
  json["speckle"] = {{"size_m", r.speckle_m}, {"size_px", r.speckle_px}};
  json["window"] = {{"ground_x_m", window_on_ground_m(r.scale, r.input.width_px)},
                    {"ground_y_m", window_on_ground_m(r.scale, r.input.height_px)},
                    {"largest_speed_x_m_s", r.largest_speed_x_m_s},
                    {"largest_speed_y_m_s", r.largest_speed_y_m_s}};
  json["noise"] = {{"sigma_px", r.input.sigma_px}, {"velocity_sigma_m_s", r.velocity_sigma_m_s}};
  json["speed"] = {{"speed_m_s", r.input.speed_m_s}, {"shift_px_per_frame", r.speed_px}};
  json["measured"] = known(r.input.measured_sc_ratio) ? measured_json(r) : ordered_json(nullptr);
  json["warnings"] = r.warnings;
  return json.dump(2) + "\n";
}

}  // namespace lsv::cli
