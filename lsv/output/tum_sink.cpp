// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/tum_sink.h"

#include <cmath>

#include "lsv/output/number_text.h"

namespace lsv {
namespace {

constexpr int kMetricDecimals = 9;

bool has_pose(const StepReport& report) {
  const ShiftStatus status = report.shift.status;
  return (status == ShiftStatus::ok || status == ShiftStatus::first_frame) &&
         std::isfinite(report.position.x_m) && std::isfinite(report.position.y_m);
}

}  // namespace

Result<void> TumSink::write(const StepReport& report) {
  if (!has_pose(report)) return {};
  row_.clear();
  append_seconds(row_, report.stamp.ns);
  row_ += ' ';
  append_fixed(row_, report.position.x_m, kMetricDecimals);
  row_ += ' ';
  append_fixed(row_, report.position.y_m, kMetricDecimals);
  row_ += " 0 0 0 0 1\n";
  return file_.write(row_);
}

Result<void> TumSink::finish(const RunEnd&) { return file_.complete(); }

}  // namespace lsv
