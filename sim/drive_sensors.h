// SPDX-License-Identifier: BSD-3-Clause
// What instruments say of a simulated drive: a reference system about the body, and laser speckle
// sensors on it about the ground under them.
//
// A sensor at (x_m, y_m) of the body frame moves with the velocity v + yaw rate z x r, whose
// integral in body axes is closed: (way - y_m yaw, x_m yaw). The sensor reads it turned by -yaw_rad
// into its own axes and times `reads_ratio`: positive along its x axis when it moves forward there.
// Units as in the names; noise by (seed, stream, row) as in philox.h. Pure functions; they
// allocate.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/body_drive.h"

namespace lsv::sim {

struct ReferenceConfig {
  double rate_hz = 50.0;  // > 0
  double begin_s = 0.0;   // of the drive
  double end_s = 60.0;    // > begin_s
  double sigma_m = 0.0;   // per axis
  double sigma_yaw_rad = 0.0;
  std::uint64_t seed = 1;
};

struct ReferenceReading {
  std::int64_t time_ns = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

std::vector<ReferenceReading> read_reference(const BodyDrive& drive, const ReferenceConfig& config);

struct SensorPlace {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;      // of its x axis in the body frame
  double reads_ratio = 1.0;  // travel it reports / true travel
};

struct Interval {
  double begin_s = 0.0;
  double end_s = 0.0;
};

struct TrackingConfig {
  double rate_hz = 500.0;  // > 0
  double begin_s = 0.0;    // of the drive
  double end_s = 60.0;
  double clock_ahead_s = 0.0;  // by which its clock is ahead of that of the reference
  double sigma_m = 0.0;        // of one shift, per axis
  /// Of the frames, refused one at a time: the next accepted shift spans the hole.
  double refused_ratio = 0.0;
  /// The ground is lost: all is refused, and what was travelled in the meantime is never known.
  std::vector<Interval> lost{};
  std::uint64_t seed = 1;
};

struct TrackReading {
  std::int64_t time_ns = 0;
  std::int64_t since_ns = 0;  // time of the frame that the shift is from
  bool accepted = false;
  double dx_m = 0.0;  // in the axes of the sensor; 0 when refused
  double dy_m = 0.0;
};

/// One reading per frame after the first.
std::vector<TrackReading> read_track(const BodyDrive& drive, const SensorPlace& place,
                                     const TrackingConfig& config);

}  // namespace lsv::sim
