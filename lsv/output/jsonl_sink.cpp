// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/jsonl_sink.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace lsv {
namespace {

using nlohmann::ordered_json;

double seconds(std::int64_t time_ns) {
  return static_cast<double>(time_ns) / static_cast<double>(kNsPerS);
}

ordered_json row_of(const StepReport& report) {
  const Shift& shift = report.shift;
  const bool ok = shift.status == ShiftStatus::ok;
  const bool first = shift.status == ShiftStatus::first_frame;
  // nlohmann writes a non-finite number as null, which is what unknown means here.
  const auto if_ok = [ok](double value) { return ok ? value : kUnknown; };

  ordered_json row;
  row["frame"] = report.frame;
  row["time_ns"] = report.stamp.ns;
  row["time_s"] = seconds(report.stamp.ns);
  row["dt_s"] = seconds(report.dt_ns);
  row["status"] = word(shift.status);
  row["held"] = !ok && !first;
  row["zncc"] = shift.quality.zncc;
  row["q"] = shift.quality.q;
  row["peak_ratio"] = shift.quality.peak_ratio;
  row["peak_to_rms"] = shift.quality.peak_to_rms;
  row["zncc_sigmas"] = shift.quality.zncc_sigmas;
  row["outlier_probability"] = shift.quality.outlier_probability;
  row["dx_px"] = if_ok(shift.dx_px);
  row["dy_px"] = if_ok(shift.dy_px);
  row["cov_px2"] = {if_ok(shift.cov.xx_px2), if_ok(shift.cov.xy_px2), if_ok(shift.cov.yy_px2)};
  row["vx_m_s"] = if_ok(report.velocity.vx_m_s);
  row["vy_m_s"] = if_ok(report.velocity.vy_m_s);
  row["sigma_vx_m_s"] = if_ok(report.velocity.sigma_vx_m_s);
  row["sigma_vy_m_s"] = if_ok(report.velocity.sigma_vy_m_s);
  row["x_m"] = report.position.x_m;
  row["y_m"] = report.position.y_m;
  row["sigma_x_m"] = report.position.sigma_x_m;
  row["sigma_y_m"] = report.position.sigma_y_m;
  row["search"] = word(report.search);
  row["keyframe"] = report.keyframe;
  row["segment"] = report.segment;
  row["motion"] = word(report.motion);
  row["rotation_rad"] = report.deformation.rotation_rad;
  row["sigma_rotation_rad"] = report.deformation.sigma_rotation_rad;
  row["expansion_ratio"] = report.deformation.expansion_ratio;
  row["sigma_expansion_ratio"] = report.deformation.sigma_expansion_ratio;
  row["static_share"] = report.static_share;
  return row;
}

}  // namespace

Result<void> JsonlSink::write(const StepReport& report) {
  return file_.write(row_of(report).dump() + '\n');
}

Result<void> JsonlSink::finish(const RunEnd&) { return file_.complete(); }

}  // namespace lsv
