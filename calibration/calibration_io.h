// SPDX-License-Identifier: BSD-3-Clause
// The calibration file: TOML with the unit of every number in its key.
//
//   schema = "lsv.calibration/2"
//   [sensor]
//   name = "..."                 # free text
//   pixel_pitch_x_m = 14e-6      # 1e-8 .. 1e-2
//   pixel_pitch_y_m = 14e-6
//   sc_x_ratio = 1.985           # 1e-4 .. 1e4, pattern shift on the sensor / surface travel
//   sc_y_ratio = 2.000
//   [camera]
//   noise_mean_counts = 3.0      # 0 .. 65535, dark level
//   noise_sd_counts = 0.5        # 0 .. 65535, temporal noise of a pixel; 0 only for noise-free
//   frames
//   [scale]                      # optional: orientation and uncertainty, see ScaleRecord
//   [format]                     # optional: the frames it is for, see SensorFormat
//   [maps]                       # optional: fixed pattern, see MapsRecord
//   [emva1288]                   # optional: camera, see CameraRecord
//   [mount]                      # optional: place on the vehicle, see Mount
//
// Every key of a section is required and no other is allowed. An error names file, line and key;
// there is no fallback calibration. "lsv.calibration/1" is the same without the optional sections.
#pragma once

#include <string>
#include <string_view>

#include "lsv/core/calibration.h"
#include "lsv/core/result.h"

namespace lsv {

Result<Calibration> load_calibration(const std::string& path);

/// `name` stands for the file in error messages.
Result<Calibration> parse_calibration(std::string_view text, const std::string& name);

/// The file of a valid calibration; parse_calibration() reads back the same numbers.
std::string calibration_text(const Calibration& calibration);

}  // namespace lsv
