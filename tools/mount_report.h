// SPDX-License-Identifier: BSD-3-Clause
// What `lsv calibrate mount` says: lines for the terminal and JSON for programs; the page is
// mount_page.h.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibration/mount_fit.h"
#include "calibration/mount_stretches.h"
#include "calibration/scale_ratio.h"
#include "lsv/core/calibration.h"

namespace lsv::cli {

/// What the drive says of the scale and of the clock of a sensor when both are taken as unknown,
/// whether or not that was applied. NaN where it does not tell.
struct DriveCheck {
  double scale_ratio = kUnknown;  // true travel / travel of the track
  double sigma_scale_ratio = kUnknown;
  double clock_offset_s = kUnknown;  // to be added to the times of the track
  double sigma_clock_offset_s = kUnknown;
};

struct MountedSensor {
  std::string track_file;
  std::string track_sha256;
  std::string calibration_file;
  std::string output_file;
  Calibration calibration;  // the new one
  std::size_t refused = 0;  // shifts
  std::size_t accepted = 0;
  MountFit fit;
  std::vector<MountStretch> stretches;
  bool fits_scale = false;
  bool fits_clock = false;
  DriveCheck check;
  std::optional<Mount> mirrored;  // where it would sit if its axes were mirrored
};

struct MountPair {
  std::size_t first = 0;  // of the sensors
  std::size_t second = 0;
  ScaleRatio ratio;
  double false_yaw_rad_per_m = kUnknown;
  bool is_corrected = false;
};

struct MountReport {
  std::string reference_file;
  std::string reference_sha256;
  std::vector<MountedSensor> sensors;
  std::vector<MountPair> pairs;
};

/// One line each: what a user must know before trusting the figures.
std::vector<std::string> mount_warnings(const MountReport& report);

/// What the name of a sensor is in tables.
std::string sensor_label(const MountedSensor& sensor);

/// What fits as well; only where `mirrored` is set.
std::string mirror_note(const MountedSensor& sensor);

/// The speed of the source's rover, at which false yaw is told.
inline constexpr double kRoverSpeed_m_s = 0.042;
double false_yaw_deg_per_h(const MountPair& pair);

std::string mount_text(const MountReport& report);

/// Schema "lsv.mount/1".
std::string mount_json(const MountReport& report);

}  // namespace lsv::cli
