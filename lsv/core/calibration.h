// SPDX-License-Identifier: BSD-3-Clause
// What is known of one sensor: how its pixels relate to the ground, what its camera does to light,
// where it sits on the vehicle. calibration/calibration_io.h reads and writes it.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "lsv/core/shift.h"

namespace lsv {

/// From the shift of the pattern to the travel over the ground (eqs 3.8 and 3.9 of the Masuku
/// thesis, with orientation):
///   travel_m = kx (cos a, sin a) dx_px + m ky (-sin(a + k), cos(a + k)) dy_px
/// with kx = pixel_pitch_x_m / sc_x_ratio, ky likewise, a = angle_rad, k = skew_rad, and m = -1
/// when mirrored, else 1. With a = k = 0 the travel is along the image axes.
struct ScaleOrientation {
  double angle_rad =
      0.0;                // from the reference x axis to the travel that moves the pattern along +x
  double skew_rad = 0.0;  // by how much the image axes are further apart than a right angle
  bool mirrored = false;  // turning from image x to image y is turning clockwise on the ground
};

/// Order of the rows: sc_x_ratio, sc_y_ratio, angle_rad, skew_rad.
using ScaleCovariance = std::array<std::array<double, 4>, 4>;

/// How the scale was found.
struct ScaleRecord {
  ScaleOrientation orientation;
  ScaleCovariance cov{};
  double height_m = kUnknown;  // of the sensor above the ground, where the scale holds
  std::string date;            // as the user gave it
  std::string method;
  std::string inputs_sha256;
};

/// The frames that the calibration is for, before any region is cut out.
struct SensorFormat {
  int width_px = 0;
  int height_px = 0;
  int bit_depth = 0;
};

/// What the camera does to light: the linear model of EMVA 1288, release 4.0, each figure with one
/// standard deviation. The comments give the symbols of the standard.
struct CameraRecord {
  double k_counts_per_e = kUnknown;  // K
  double sigma_k_counts_per_e = kUnknown;
  double dark_noise_e = kUnknown;  // sigma_d: over time, without the noise of rounding to counts
  double sigma_dark_noise_e = kUnknown;
  double dsnu_e = kUnknown;  // DSNU1288: from pixel to pixel, dark
  double sigma_dsnu_e = kUnknown;
  double prnu_ratio = kUnknown;  // PRNU1288: from pixel to pixel, of the signal
  double sigma_prnu_ratio = kUnknown;
  double saturation_counts = kUnknown;  // mu_y.sat
  double sigma_saturation_counts = kUnknown;
  double saturation_e = kUnknown;  // mu_e.sat
  double sigma_saturation_e = kUnknown;
  bool saturation_reached = false;  // else both are lower bounds: the brightest light measured
  int dark_frames = 0;
  int flat_frames = 0;  // of all levels of light
  int flat_levels = 0;
  std::string date;  // as the user gave it
  std::string method;
  std::string inputs_sha256;
};

/// Fixed pattern of the sensor, a file beside the calibration.
struct MapsRecord {
  std::string file;  // relative to the folder of the calibration
  std::string sha256;
};

/// Place of the sensor in the body frame (REP-103: x forward, y left), and the direction of its
/// reference x axis.
struct Mount {
  double x_m = kUnknown;
  double y_m = kUnknown;
  double yaw_rad = kUnknown;
  double sigma_x_m = kUnknown;
  double sigma_y_m = kUnknown;
  double sigma_yaw_rad = kUnknown;
};

struct Calibration {
  std::string sensor_name;
  double pixel_pitch_x_m = kUnknown;  // > 0
  double pixel_pitch_y_m = kUnknown;
  double sc_x_ratio = kUnknown;  // pattern shift on the sensor / surface travel, > 0
  double sc_y_ratio = kUnknown;
  double noise_mean_counts = kUnknown;  // dark level, >= 0
  double noise_sd_counts = kUnknown;    // temporal noise of one pixel, >= 0; 0 = noise-free frames
  /// Unset: image axes, and nobody knows how well the scale is known.
  std::optional<ScaleRecord> scale{};
  std::optional<SensorFormat> format{};
  std::optional<MapsRecord> maps{};
  std::optional<CameraRecord> camera{};
  std::optional<Mount> mount{};
  std::string digest;  // SHA-256 of the file it came from, hex
};

}  // namespace lsv
