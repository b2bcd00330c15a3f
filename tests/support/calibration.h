// SPDX-License-Identifier: BSD-3-Clause
// The calibration that tests use unless they say otherwise: the sensor of the Masuku thesis.
#pragma once

#include "lsv/core/config.h"

namespace lsv::test {

inline Calibration bridget_calibration() {
  Calibration out;
  out.sensor_name = "test";
  out.pixel_pitch_x_m = 14e-6;
  out.pixel_pitch_y_m = 14e-6;
  out.sc_x_ratio = 1.985;
  out.sc_y_ratio = 2.000;
  out.noise_mean_counts = 3.0;
  out.noise_sd_counts = 0.5;
  return out;
}

inline TrackConfig bridget_config() {
  TrackConfig out;
  out.calibration = bridget_calibration();
  return out;
}

}  // namespace lsv::test
