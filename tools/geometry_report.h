// SPDX-License-Identifier: BSD-3-Clause
// What `lsv calibrate geometry` says: the predictions of calibration/speckle_geometry.h for one
// set-up, as text for people and as JSON. Whatever was not given is kUnknown, and so is all that
// follows from it: null in the JSON, and the text names the missing option.
#pragma once

#include <string>
#include <vector>

#include "calibration/speckle_geometry.h"

namespace lsv::cli {

struct GeometryInput {
  /// Imaged speckle when the magnification is known; its sensor distance is not used.
  ObjectiveGeometry distances{};
  double wavelength_m = kUnknown;
  double spot_diameter_m = kUnknown;
  double magnification_ratio = kUnknown;
  double f_number = kUnknown;
  double focal_length_m = kUnknown;
  double pixel_pitch_m = kUnknown;
  double rate_hz = kUnknown;
  double width_px = kUnknown;
  double height_px = kUnknown;
  double speed_m_s = kUnknown;
  double sigma_px = kUnknown;
  double measured_sc_ratio = kUnknown;
  double measured_sc_sigma_ratio = kUnknown;

  bool imaged() const;
  bool collimated() const;
};

struct GeometryReport {
  GeometryInput input{};
  SensorScale scale{};
  ScSlopes slopes{};                       // objective
  double tilt_shift_m_per_rad = kUnknown;  // objective
  double tilt_travel_m_per_rad = kUnknown;
  double fixed_focus_slope_per_m = kUnknown;  // imaged
  double refocused_slope_per_m = kUnknown;
  double object_distance_m = kUnknown;
  double speckle_m = kUnknown;
  double speckle_px = kUnknown;
  double speed_px = kUnknown;  // per frame
  double largest_speed_x_m_s = kUnknown;
  double largest_speed_y_m_s = kUnknown;
  double velocity_sigma_m_s = kUnknown;
  ScExplanation explanation{};  // objective; imaged: the difference only
  double defocus_m = kUnknown;  // imaged
  double defocus_sigma_m = kUnknown;
  std::vector<std::string> warnings;
};

GeometryReport predict(const GeometryInput& input);

std::string geometry_text(const GeometryReport& report);

/// Schema "lsv.geometry/1".
std::string geometry_json(const GeometryReport& report);

}  // namespace lsv::cli
