// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/speckle_geometry.h"

#include <cmath>

namespace lsv {
namespace {

/// No change is 0 also where both distances are infinite.
double change_m(double now_m, double before_m) {
  return now_m == before_m ? 0.0 : now_m - before_m;
}

std::optional<DistanceChange> source_change(const ObjectiveGeometry& g, double sc, double sigma) {
  const double excess = sc - 1.0;
  if (!(excess >= 0.0)) return std::nullopt;
  const double source_m = g.sensor_distance_m / excess;
  return DistanceChange{.distance_m = source_m,
                        .change_m = change_m(source_m, g.source_distance_m),
                        .sigma_m = source_m / excess * sigma};
}

std::optional<DistanceChange> sensor_change(const ObjectiveGeometry& g, double sc, double sigma) {
  if (std::isinf(g.source_distance_m)) return std::nullopt;
  const double sensor_m = (sc - 1.0) * g.source_distance_m;
  if (!(sensor_m > 0.0)) return std::nullopt;
  return DistanceChange{.distance_m = sensor_m,
                        .change_m = change_m(sensor_m, g.sensor_distance_m),
                        .sigma_m = g.source_distance_m * sigma};
}

/// Sc - 2 = (L_o - R_s) / (R_s + h): the numerator is what a common height leaves alone.
std::optional<DistanceChange> height_change(const ObjectiveGeometry& g, double sc, double sigma) {
  if (std::isinf(g.source_distance_m)) return std::nullopt;
  const double beyond_m = g.sensor_distance_m - g.source_distance_m;
  if (beyond_m == 0.0) return std::nullopt;
  const double source_m = beyond_m / (sc - 2.0);
  const double sensor_m = source_m + beyond_m;
  if (!(source_m > 0.0 && sensor_m > 0.0) || std::isinf(source_m)) return std::nullopt;
  return DistanceChange{.distance_m = sensor_m,
                        .change_m = source_m - g.source_distance_m,
                        .sigma_m = std::abs(source_m / (sc - 2.0)) * sigma};
}

std::optional<AngleChange> incidence_change(const ObjectiveGeometry& g, double sc, double sigma) {
  const double cos2_per_ratio = g.source_distance_m / g.sensor_distance_m;
  const double cos2 = (sc - 1.0) * cos2_per_ratio;
  if (!(cos2 > 0.0 && cos2 <= 1.0)) return std::nullopt;
  const double angle_rad = std::acos(std::sqrt(cos2));
  return AngleChange{.angle_rad = angle_rad,
                     .sigma_rad = cos2_per_ratio * sigma / std::sin(2.0 * angle_rad)};
}

}  // namespace

double predicted_sc(const ObjectiveGeometry& g) {
  return 1.0 + g.sensor_distance_m / g.source_distance_m;
}

ScSlopes sc_slopes(const ObjectiveGeometry& g) {
  if (std::isinf(g.source_distance_m)) return {0.0, 0.0, 0.0};
  const double curvature_per_m = 1.0 / g.source_distance_m;
  return {.source_per_m = -g.sensor_distance_m * curvature_per_m * curvature_per_m,
          .sensor_per_m = curvature_per_m,
          .height_per_m =
              (g.source_distance_m - g.sensor_distance_m) * curvature_per_m * curvature_per_m};
}

double tilt_shift_m_per_rad(const ObjectiveGeometry& g) { return 2.0 * g.sensor_distance_m; }

double tilt_travel_m_per_rad(const ObjectiveGeometry& g) {
  return tilt_shift_m_per_rad(g) / predicted_sc(g);
}

double objective_speckle_m(double wavelength_m, double sensor_distance_m, double spot_diameter_m) {
  return wavelength_m * sensor_distance_m / spot_diameter_m;
}

double imaged_speckle_m(double wavelength_m, double magnification, double f_number) {
  return wavelength_m * (1.0 + magnification) * f_number;
}

double object_distance_m(double focal_length_m, double magnification) {
  return focal_length_m * (1.0 + 1.0 / magnification);
}

double refocused_slope_per_m(double focal_length_m, double magnification) {
  return -magnification / focal_length_m;
}

double fixed_focus_slope_per_m(double source_distance_m) { return 1.0 / source_distance_m; }

double imaged_tilt_travel_m_per_rad(double defocus_m) { return 2.0 * defocus_m; }

double surface_m_per_px(const SensorScale& s) { return s.pixel_pitch_m / s.sc_ratio; }

double window_on_ground_m(const SensorScale& s, double window_px) {
  return window_px * surface_m_per_px(s);
}

double shift_px_per_frame(const SensorScale& s, double speed_m_s) {
  return speed_m_s / (surface_m_per_px(s) * s.rate_hz);
}

double largest_speed_m_s(const SensorScale& s, double window_px) {
  return kLargestShiftFraction * window_px * surface_m_per_px(s) * s.rate_hz;
}

double velocity_sigma_m_s(const SensorScale& s, double sigma_px) {
  return sigma_px * surface_m_per_px(s) * s.rate_hz;
}

ScExplanation explain_sc(const ObjectiveGeometry& assumed, double measured_sc,
                         double measured_sc_sigma) {
  return {.difference_ratio = measured_sc - predicted_sc(assumed),
          .source = source_change(assumed, measured_sc, measured_sc_sigma),
          .sensor = sensor_change(assumed, measured_sc, measured_sc_sigma),
          .height = height_change(assumed, measured_sc, measured_sc_sigma),
          .incidence = incidence_change(assumed, measured_sc, measured_sc_sigma)};
}

double defocus_for_sc_m(double source_distance_m, double magnification, double measured_sc) {
  if (std::isinf(source_distance_m)) return kUnknown;
  return source_distance_m * (measured_sc / magnification - 1.0);
}

}  // namespace lsv
