// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/report_series.h"

#include <algorithm>
#include <cmath>

namespace lsv {
namespace {

ReportPoint point_of(const StepReport& report) {
  const Shift& shift = report.shift;
  ReportPoint point;
  point.first_frame = point.last_frame = report.frame;
  point.last_ns = report.stamp.ns;
  point.last_position = report.position;
  point.count_by_status[static_cast<std::size_t>(shift.status)] = 1;
  if (shift.status == ShiftStatus::ok) {
    point.vx_m_s.add(report.velocity.vx_m_s);
    point.vy_m_s.add(report.velocity.vy_m_s);
    point.sigma_vx_m_s.add(report.velocity.sigma_vx_m_s);
    point.sigma_vy_m_s.add(report.velocity.sigma_vy_m_s);
    point.zncc.add(shift.quality.zncc);
    point.q.add(shift.quality.q);
  } else {
    point.refused_zncc.add(shift.quality.zncc);
    point.refused_q.add(shift.quality.q);
  }
  return point;
}

}  // namespace

void Spread::add(double value) {
  if (!std::isfinite(value)) return;
  ++count_;
  sum_ += value;
  min_ = std::min(min_, value);
  max_ = std::max(max_, value);
}

void Spread::join(const Spread& later) {
  count_ += later.count_;
  sum_ += later.sum_;
  min_ = std::min(min_, later.min_);
  max_ = std::max(max_, later.max_);
}

double Spread::mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : kUnknown; }

void ReportPoint::join(const ReportPoint& later) {
  last_frame = later.last_frame;
  last_ns = later.last_ns;
  last_position = later.last_position;
  vx_m_s.join(later.vx_m_s);
  vy_m_s.join(later.vy_m_s);
  sigma_vx_m_s.join(later.sigma_vx_m_s);
  sigma_vy_m_s.join(later.sigma_vy_m_s);
  zncc.join(later.zncc);
  q.join(later.q);
  refused_zncc.join(later.refused_zncc);
  refused_q.join(later.refused_q);
  for (std::size_t i = 0; i < count_by_status.size(); ++i)
    count_by_status[i] += later.count_by_status[i];
}

void ReportSeries::add(const StepReport& report) {
  if (points_.empty()) first_ns_ = report.stamp.ns;
  if (!points_.empty() && frames_in_last_ < frames_per_point_) {
    points_.back().join(point_of(report));
    ++frames_in_last_;
    return;
  }
  if (points_.size() == kMaxPoints) halve();
  points_.push_back(point_of(report));
  frames_in_last_ = 1;
}

void ReportSeries::halve() {
  static_assert(kMaxPoints % 2 == 0, "every point has a neighbour to join");
  for (std::size_t i = 0; i < points_.size() / 2; ++i) {
    ReportPoint joined = points_[2 * i];
    joined.join(points_[2 * i + 1]);
    points_[i] = joined;
  }
  points_.resize(points_.size() / 2);
  frames_per_point_ *= 2;
}

}  // namespace lsv
