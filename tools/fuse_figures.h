// SPDX-License-Identifier: BSD-3-Clause
// What `lsv fuse` counts of a whole drive, and what of it a user must know before trusting the
// pose. Memory does not grow with the length of the drive.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "tools/fuse_run.h"

namespace lsv::cli {

/// NIS of one kind of measurement, of those within the gate.
struct NisFigures {
  std::size_t count = 0;
  double sum = 0.0;
  double dof_sum = 0.0;
  std::size_t inside = 0;       // the 95 % band of one measurement, two-sided
  std::size_t beyond_gate = 0;  // outliers and jumps; not in the others
  double mean_per_dof() const;  // NaN: none
  double inside_share() const;
};

/// Of the readings of one LSV sensor.
struct LsvFigures {
  std::size_t used = 0;
  std::size_t refused = 0;
  Stamp last_used{};  // where `used` > 0
};

struct SlipFigures {
  double slips_s = 0.0;
  double known_s = 0.0;  // while optics watched a wheel that turned
  double slip_time_s() const { return known_s > 0.0 ? slips_s : kUnknown; }
};

/// Readings of a wheel while optics told the ground speed.
struct SkidFigures {
  std::size_t readings = 0;
  std::size_t skids = 0;  // the ground passes far faster than the rim turns
};

class FuseFigures {
 public:
  explicit FuseFigures(const FusionConfig& config) : config_(config) {}
  void add(const FuseRow& row);
  void finish(const FusionCounters& counters, std::size_t rows_read, std::size_t rows_left_out,
              std::size_t events);

  const FusionConfig& config() const { return config_; }
  double duration_s() const { return seconds_between(first.stamp, last.stamp); }
  double status_s(NavStatus status) const { return status_s_[static_cast<std::size_t>(status)]; }

  NavState first{};
  NavState last{};
  std::size_t poses = 0;
  double path_m = 0.0;  // integral of the speed: a correction of the position is no way
  SlipFigures left_slip{}, right_slip{};
  SkidFigures left_skid{}, right_skid{};
  NisFigures lsv_nis{}, wheel_nis{}, gyro_nis{};
  std::array<LsvFigures, kMaxLsvSensors> lsv{};
  FusionCounters counters{};
  std::size_t rows_read = 0;
  std::size_t rows_left_out = 0;
  std::size_t events = 0;

 private:
  void add_skids(const NavState& state, const WheelSample& wheels);

  FusionConfig config_;
  std::array<double, 4> status_s_{};  // time spent in each NavStatus
};

/// One sentence each.
std::vector<std::string> fuse_warnings(const FuseFigures& figures);

}  // namespace lsv::cli
