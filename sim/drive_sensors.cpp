// SPDX-License-Identifier: BSD-3-Clause
#include "sim/drive_sensors.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "sim/philox.h"

namespace lsv::sim {
namespace {

std::int64_t to_ns(double time_s) { return std::llround(time_s * 1e9); }

std::int64_t rows(double begin_s, double end_s, double rate_hz) {
  constexpr double kRounding = 1e-9;
  return static_cast<std::int64_t>(std::floor((end_s - begin_s) * rate_hz * (1.0 + kRounding))) + 1;
}

/// Two independent standard normal numbers.
std::complex<double> normal_pair(std::uint64_t seed, Stream stream, std::int64_t row,
                                 std::int64_t kind) {
  return std::sqrt(2.0) * complex_normal(seed, stream, row, kind, 0);
}

/// What the sensor has travelled since the start, in its own axes, as it reads it.
std::complex<double> read_way(const BodyWay& way, const SensorPlace& place) {
  const std::complex<double> body_m(way.way_m - place.y_m * way.yaw_rad, place.x_m * way.yaw_rad);
  return place.reads_ratio * body_m * std::polar(1.0, -place.yaw_rad);
}

bool is_lost(double time_s, const std::vector<Interval>& lost) {
  return std::any_of(lost.begin(), lost.end(), [time_s](const Interval& interval) {
    return time_s >= interval.begin_s && time_s < interval.end_s;
  });
}

}  // namespace

std::vector<ReferenceReading> read_reference(const BodyDrive& drive,
                                             const ReferenceConfig& config) {
  std::vector<ReferenceReading> out;
  const std::int64_t count = rows(config.begin_s, config.end_s, config.rate_hz);
  for (std::int64_t row = 0; row < count; ++row) {
    const std::int64_t time_ns = to_ns(config.begin_s + static_cast<double>(row) / config.rate_hz);
    const BodyPose pose = drive.pose(1e-9 * static_cast<double>(time_ns));
    const auto place = normal_pair(config.seed, Stream::reference_pose, row, 0);
    const auto heading = normal_pair(config.seed, Stream::reference_pose, row, 1);
    out.push_back({.time_ns = time_ns,
                   .x_m = pose.x_m + config.sigma_m * place.real(),
                   .y_m = pose.y_m + config.sigma_m * place.imag(),
                   .yaw_rad = pose.yaw_rad + config.sigma_yaw_rad * heading.real()});
  }
  return out;
}

std::vector<TrackReading> read_track(const BodyDrive& drive, const SensorPlace& place,
                                     const TrackingConfig& config) {
  std::vector<TrackReading> out;
  const std::int64_t count = rows(config.begin_s, config.end_s, config.rate_hz);
  const std::int64_t ahead_ns = to_ns(config.clock_ahead_s);
  std::int64_t since_ns = 0;
  std::complex<double> since_m = 0.0;
  bool was_lost = false;
  for (std::int64_t row = 0; row < count; ++row) {
    const std::int64_t time_ns = to_ns(config.begin_s + static_cast<double>(row) / config.rate_hz);
    const double time_s = 1e-9 * static_cast<double>(time_ns);
    const std::complex<double> way_m = read_way(drive.way(time_s), place);
    const bool lost = is_lost(time_s, config.lost);
    const bool refused =
        uniform_pair(config.seed, Stream::sensor_track, row, 1, 0)[0] <= config.refused_ratio;
    TrackReading reading{.time_ns = time_ns + ahead_ns, .since_ns = since_ns + ahead_ns};
    // The first frame after a loss is the one that the next shift is from: nothing is known of it.
    reading.accepted = row > 0 && !lost && !was_lost && !refused;
    if (reading.accepted) {
      const auto noise = config.sigma_m * normal_pair(config.seed, Stream::sensor_track, row, 0);
      reading.dx_m = (way_m - since_m + noise).real();
      reading.dy_m = (way_m - since_m + noise).imag();
    }
    if (row > 0) out.push_back(reading);
    if (row == 0 || reading.accepted || was_lost) {
      since_ns = time_ns;
      since_m = way_m;
    }
    was_lost = lost;
  }
  return out;
}

}  // namespace lsv::sim
