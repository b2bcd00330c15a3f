// SPDX-License-Identifier: BSD-3-Clause
// The frames of a run gathered into at most kMaxPoints points. A point stands for one frame until
// the points run out; then neighbours are joined two by two and each point stands for twice as
// many. Joining keeps the extremes, the means and the count of every refusal, so a single refused
// frame or spike stays visible in a run of any length.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "lsv/core/step_report.h"

namespace lsv {

/// Mean and extremes of the finite values added.
class Spread {
 public:
  void add(double value);
  void join(const Spread& later);
  double mean() const;
  double min() const { return count_ > 0 ? min_ : kUnknown; }
  double max() const { return count_ > 0 ? max_ : kUnknown; }

 private:
  std::int64_t count_ = 0;
  double sum_ = 0.0;
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
};

struct ReportPoint {
  std::int64_t first_frame = 0;
  std::int64_t last_frame = 0;
  std::int64_t last_ns = 0;      // stamp of the last frame
  SensorPosition last_position;  // after the last frame
  Spread vx_m_s, vy_m_s, sigma_vx_m_s, sigma_vy_m_s;
  Spread zncc, q;                  // of accepted shifts
  Spread refused_zncc, refused_q;  // of refused ones, where measured
  std::array<std::int64_t, kAllShiftStatuses.size()> count_by_status{};

  void join(const ReportPoint& later);
};

class ReportSeries {
 public:
  static constexpr std::size_t kMaxPoints = 4000;

  ReportSeries() { points_.reserve(kMaxPoints); }

  void add(const StepReport& report);

  const std::vector<ReportPoint>& points() const { return points_; }
  std::int64_t frames_per_point() const { return frames_per_point_; }
  std::int64_t first_ns() const { return first_ns_; }

 private:
  void halve();

  std::vector<ReportPoint> points_;
  std::int64_t frames_per_point_ = 1;
  std::int64_t frames_in_last_ = 0;
  std::int64_t first_ns_ = 0;
};

}  // namespace lsv
