// SPDX-License-Identifier: BSD-3-Clause
// What `lsv fuse` says of a whole drive: figures, and curves for the page. Memory does not grow
// with the length of the drive.
#pragma once

#include <string>
#include <vector>

#include "tools/fuse_figures.h"
#include "tools/fuse_run.h"
#include "tools/xy_plot.h"

namespace lsv::cli {

/// A curve that keeps every n-th point, n doubling as it fills; and where it is broken.
class ThinCurve {
 public:
  void add(double x, double y);
  /// The next point begins a new line.
  void end_line() { is_broken_ = !points_.empty(); }
  const std::vector<Point>& points() const { return points_; }

 private:
  std::vector<Point> points_;
  std::size_t every_ = 1;
  std::size_t seen_ = 0;
  bool is_broken_ = false;
};

/// What was read, for the record.
struct FuseInputNames {
  std::vector<std::string> files;  // samples, then the rover
  std::string rover_sha256;
};

class FuseReport {
 public:
  explicit FuseReport(const FusionConfig& config) : figures_(config) {}
  void add(const FuseRow& row);
  void finish(const FusionCounters& counters, const FuseSamples& samples, std::size_t events);

  std::vector<std::string> warnings() const { return fuse_warnings(figures_); }
  /// Lines for the terminal.
  std::string text() const;
  /// Schema "lsv.fusion/1".
  std::string json(const FuseInputNames& inputs) const;
  std::string html(const FuseInputNames& inputs) const;

 private:
  struct Ellipse {
    NavState at;
  };
  struct StatusSpan {
    NavStatus status;
    double begin_s, end_s;
  };
  struct SlipCurves {
    ThinCurve middle, low, high;
    void add(double time_s, const WheelGrip& grip);
  };
  void follow_status(const NavState& state, double time_s);
  void end_lines();
  void draw_outages(XyPlot& plot) const;
  std::string path_svg() const;

  FuseFigures figures_;
  ThinCurve path_, guessed_path_, speed_, encoder_speed_, side_slip_, yaw_rate_, yaw_;
  SlipCurves left_, right_;
  ThinCurve sigma_, lsv_nis_curve_, wheel_nis_curve_;
  std::vector<ThinCurve> sensor_speed_ = std::vector<ThinCurve>(kMaxLsvSensors);
  std::vector<Ellipse> ellipses_;
  std::size_t ellipse_every_ = 1;
  std::vector<StatusSpan> outages_;  // the first of them
};

}  // namespace lsv::cli
