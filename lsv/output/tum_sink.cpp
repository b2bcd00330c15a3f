// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/tum_sink.h"

#include <cmath>

#include "lsv/output/tum_pose.h"

namespace lsv {
namespace {

bool has_pose(const StepReport& report) {
  const ShiftStatus status = report.shift.status;
  return (status == ShiftStatus::ok || status == ShiftStatus::first_frame) &&
         std::isfinite(report.position.x_m) && std::isfinite(report.position.y_m);
}

}  // namespace

Result<void> TumSink::write(const StepReport& report) {
  if (!has_pose(report)) return {};
  row_.clear();
  append_tum_pose(row_, report.stamp, report.position.x_m, report.position.y_m);
  return file_.write(row_);
}

Result<void> TumSink::finish(const RunEnd&) { return file_.complete(); }

}  // namespace lsv
