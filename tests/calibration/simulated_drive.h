// SPDX-License-Identifier: BSD-3-Clause
// The simulated instruments of sim/drive_sensors.h as calibration takes them.
#pragma once

#include <algorithm>

#include "calibration/drive.h"
#include "sim/drive_sensors.h"

namespace lsv::test {

inline BodyReference body_reference(const sim::BodyDrive& drive,
                                    const sim::ReferenceConfig& config) {
  constexpr double kExact = 1e-6;
  BodyReference out;
  for (const sim::ReferenceReading& r : sim::read_reference(drive, config))
    out.push_back({.stamp = {r.time_ns},
                   .x_m = r.x_m,
                   .y_m = r.y_m,
                   .yaw_rad = r.yaw_rad,
                   .sigma_m = std::max(config.sigma_m, kExact),
                   .sigma_yaw_rad = std::max(config.sigma_yaw_rad, kExact)});
  return out;
}

inline SensorTrack sensor_track(const sim::BodyDrive& drive, const sim::SensorPlace& place,
                                const sim::TrackingConfig& config) {
  const double variance_m2 = config.sigma_m * config.sigma_m;
  SensorTrack out;
  bool refused = false;
  for (const sim::TrackReading& r : sim::read_track(drive, place, config)) {
    if (r.accepted) {
      const bool bridges = refused && !out.empty() && out.back().end.ns == r.since_ns;
      out.push_back({.begin = {r.since_ns},
                     .end = {r.time_ns},
                     .dx_m = r.dx_m,
                     .dy_m = r.dy_m,
                     .xx_m2 = variance_m2,
                     .yy_m2 = variance_m2,
                     .spans_refused = bridges});
    }
    refused = !r.accepted;
  }
  return out;
}

}  // namespace lsv::test
