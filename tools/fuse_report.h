// SPDX-License-Identifier: BSD-3-Clause
// What `lsv fuse` says of a whole drive: figures, and curves for the page. Memory does not grow
// with the length of the drive.
#pragma once

#include <string>
#include <vector>

#include "tools/fuse_run.h"
#include "tools/xy_plot.h"

namespace lsv::cli {

/// A curve that keeps every n-th point, n doubling as it fills.
class ThinCurve {
 public:
  void add(double x, double y);
  const std::vector<Point>& points() const { return points_; }

 private:
  std::vector<Point> points_;
  std::size_t every_ = 1;
  std::size_t seen_ = 0;
};

/// NIS of one kind of measurement, of those within the gate.
struct NisFigures {
  std::size_t count = 0;
  double sum = 0.0;
  double dof_sum = 0.0;
  std::size_t inside = 0;  // the 95 % band of one measurement, two-sided
  double mean_per_dof() const;
  double inside_share() const;
};

class FuseReport {
 public:
  explicit FuseReport(const FusionConfig& config) : config_(config) {}
  void add(const FuseRow& row);
  void finish(const FusionCounters& counters, std::size_t rows_left_out, std::size_t events);

  /// Lines for the terminal.
  std::string text() const;
  /// Schema "lsv.fusion/1".
  std::string json(const std::vector<std::string>& inputs, const std::string& rover_sha256) const;
  std::string html() const;

 private:
  struct Ellipse {
    NavState at;
  };
  std::string path_svg() const;

  FusionConfig config_;
  FusionCounters counters_{};
  std::size_t rows_left_out_ = 0;
  std::size_t events_ = 0;
  std::size_t rows_ = 0;
  NavState first_{};
  NavState last_{};
  double path_m_ = 0.0;
  double status_s_[4] = {};  // time spent in each NavStatus
  double left_slip_s_ = 0.0, right_slip_s_ = 0.0;
  NisFigures lsv_nis_{}, wheel_nis_{}, gyro_nis_{};
  ThinCurve path_, speed_, encoder_speed_, side_slip_, yaw_rate_, yaw_;
  ThinCurve left_, left_low_, left_high_, right_;
  ThinCurve sigma_, lsv_nis_curve_, wheel_nis_curve_;
  std::vector<ThinCurve> sensor_speed_ = std::vector<ThinCurve>(kMaxLsvSensors);
  std::vector<Ellipse> ellipses_;
  std::size_t ellipse_every_ = 1;
};

}  // namespace lsv::cli
