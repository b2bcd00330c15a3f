// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/summary.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lsv/output/number_text.h"
#include "lsv/output/run_settings.h"

namespace lsv {
namespace {

using nlohmann::ordered_json;

constexpr double kClassRatio = 1.01;

double seconds(std::int64_t time_ns) {
  return static_cast<double>(time_ns) / static_cast<double>(kNsPerS);
}

bool is_rejected(ShiftStatus status) {
  return status != ShiftStatus::ok && status != ShiftStatus::first_frame;
}

ordered_json to_json(const Setting& setting) {
  return std::visit([](const auto& value) { return ordered_json(value); }, setting.value);
}

ordered_json settings_json(const RunInfo& info) {
  ordered_json out;
  for (const Setting& setting : run_settings(info))
    out[std::string(setting.key)] = to_json(setting);
  out["units"] = kUnits;
  out["sign_convention"] = kSignConvention;
  return out;
}

ordered_json rejected_json(const Summary& summary) {
  ordered_json out = ordered_json::object();
  for (const auto& [status, count] : summary.rejected) out[std::string(word(status))] = count;
  return out;
}

/// "0.125000 m", or "unknown".
std::string with_unit(double value, int decimals, const char* unit) {
  std::string out;
  append_fixed(out, value, decimals);
  if (out.empty()) return "unknown";
  return out + unit;
}

/// Four significant digits with the prefix that suits them: "3.768 mm", "12.50 km/s".
std::string in_prefixed(double value, const char* unit) {
  if (!std::isfinite(value)) return "unknown";
  constexpr std::pair<double, const char*> kPrefixes[] = {
      {1e3, " k"}, {1.0, " "}, {1e-3, " m"}, {1e-6, " u"}, {1e-9, " n"}};
  const double magnitude = std::abs(value);
  const auto* prefix = std::begin(kPrefixes) + 1;  // zero is shown in the plain unit
  if (magnitude > 0.0) {
    prefix = std::find_if(std::begin(kPrefixes), std::end(kPrefixes) - 1,
                          [&](const auto& p) { return magnitude >= 0.99995 * p.first; });
  }
  const double scaled = value / prefix->first;
  const int whole_digits = std::abs(scaled) >= 99.995 ? 3 : std::abs(scaled) >= 9.9995 ? 2 : 1;
  return with_unit(scaled, 4 - whole_digits, prefix->second) + unit;
}

std::string rejected_text(const Summary& summary) {
  std::string out = std::to_string(summary.shifts_rejected) + " rejected";
  if (summary.shifts_rejected == 0) return out;
  out += " (" + with_unit(100.0 * summary.rejected_share, 2, " %") + ")";
  const char* separator = ": ";
  for (const auto& [status, count] : summary.rejected) {
    out += separator + std::to_string(count) + " " + std::string(word(status));
    separator = ", ";
  }
  return out;
}

}  // namespace

void MedianCounter::add(double value) {
  if (!std::isfinite(value) || value <= 0.0) return;
  const double position = std::log(value) / std::log(kClassRatio);
  const double top = kClasses - 1;
  ++counts_[static_cast<std::size_t>(std::clamp(std::floor(position), 0.0, top))];
  ++total_;
}

double MedianCounter::median() const {
  std::int64_t seen = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    seen += counts_[i];
    if (total_ > 0 && 2 * seen >= total_)
      return std::pow(kClassRatio, static_cast<double>(i) + 0.5);
  }
  return kUnknown;
}

SummaryBuilder::SummaryBuilder(RunInfo info, std::optional<OutputFile> file)
    : info_(std::move(info)), file_(std::move(file)) {}

Result<void> SummaryBuilder::write(const StepReport& report) {
  if (frames_ == 0) {
    first_ns_ = report.stamp.ns;
  } else {
    add_gap(report);
  }
  ++frames_;
  ++count_by_status_[static_cast<std::size_t>(report.shift.status)];
  if (report.shift.status == ShiftStatus::ok) add_accepted(report);
  if (is_rejected(report.shift.status)) held_ns_ += report.stamp.ns - last_.stamp.ns;
  last_ = report;
  return {};
}

void SummaryBuilder::add_gap(const StepReport& report) {
  const std::int64_t steps =
      (report.frame - last_.frame) / std::max<std::int64_t>(info_.index_step, 1);
  missing_frames_ += std::max<std::int64_t>(steps - 1, 0);
}

void SummaryBuilder::add_accepted(const StepReport& report) {
  path_length_m_ += std::hypot(report.position.x_m - last_.position.x_m,
                               report.position.y_m - last_.position.y_m);
  accepted_ns_ += report.dt_ns;
  // fmax: the first speed replaces the unknown.
  max_speed_m_s_ =
      std::fmax(max_speed_m_s_, std::hypot(report.velocity.vx_m_s, report.velocity.vy_m_s));
  zncc_sum_ += report.shift.quality.zncc;
  q_.add(report.shift.quality.q);
}

Result<void> SummaryBuilder::finish(const RunEnd& end) {
  interrupted_ = end.interrupted;
  if (!file_) return {};
  if (auto written = file_->write(summary_json(info_, summary())); !written) return written;
  return file_->complete();
}

Result<void> SummaryBuilder::commit() {
  if (!file_) return {};
  return file_->commit();
}

Summary SummaryBuilder::summary() const {
  Summary out;
  out.frames = frames_;
  for (const ShiftStatus status : kAllShiftStatuses) {
    const std::int64_t count = count_by_status_[static_cast<std::size_t>(status)];
    if (count == 0 || !is_rejected(status)) continue;
    out.rejected.emplace_back(status, count);
    out.shifts_rejected += count;
  }
  out.shifts_ok = count_by_status_[static_cast<std::size_t>(ShiftStatus::ok)];
  const auto ok = static_cast<double>(out.shifts_ok);
  const auto rejected = static_cast<double>(out.shifts_rejected);
  out.rejected_share = rejected / (ok + rejected);  // 0 / 0 is unknown
  out.missing_frames = missing_frames_;
  if (frames_ > 0) out.duration_s = seconds(last_.stamp.ns - first_ns_);
  out.held_time_s = seconds(held_ns_);
  out.path_length_m = path_length_m_;
  out.end = frames_ > 0 ? last_.position : SensorPosition{kUnknown, kUnknown, kUnknown, kUnknown};
  out.mean_speed_m_s = path_length_m_ / seconds(accepted_ns_);
  out.max_speed_m_s = max_speed_m_s_;
  out.mean_zncc = zncc_sum_ / ok;
  out.median_q = q_.median();
  out.static_share = last_.static_share;
  out.interrupted = interrupted_;
  return out;
}

std::string summary_json(const RunInfo& info, const Summary& summary) {
  ordered_json out;
  out["frames"] = summary.frames;
  out["shifts_ok"] = summary.shifts_ok;
  out["shifts_rejected"] = summary.shifts_rejected;
  out["rejected_by_reason"] = rejected_json(summary);
  out["rejected_share"] = summary.rejected_share;
  out["missing_frames"] = summary.missing_frames;
  out["duration_s"] = summary.duration_s;
  out["held_time_s"] = summary.held_time_s;
  out["path_length_m"] = summary.path_length_m;
  out["end_x_m"] = summary.end.x_m;
  out["end_y_m"] = summary.end.y_m;
  out["end_sigma_x_m"] = summary.end.sigma_x_m;
  out["end_sigma_y_m"] = summary.end.sigma_y_m;
  out["mean_speed_m_s"] = summary.mean_speed_m_s;
  out["max_speed_m_s"] = summary.max_speed_m_s;
  out["mean_zncc"] = summary.mean_zncc;
  out["median_q"] = summary.median_q;
  out["static_share"] = summary.static_share;
  out["interrupted"] = summary.interrupted;
  out["settings"] = settings_json(info);
  return out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n';
}

std::string summary_text(const Summary& summary) {
  std::string out;
  out += "frames   " + std::to_string(summary.frames) + ", " +
         std::to_string(summary.missing_frames) + " missing\n";
  out += "shifts   " + std::to_string(summary.shifts_ok) + " ok, " + rejected_text(summary) + "\n";
  out += "time     " + with_unit(summary.duration_s, 3, " s") + ", position held for " +
         with_unit(summary.held_time_s, 3, " s") + "\n";
  out += "path     " + in_prefixed(summary.path_length_m, "m") + "\n";
  out += "end      x " + in_prefixed(summary.end.x_m, "m") + " (sigma " +
         in_prefixed(summary.end.sigma_x_m, "m") + "), y " + in_prefixed(summary.end.y_m, "m") +
         " (sigma " + in_prefixed(summary.end.sigma_y_m, "m") + ")\n";
  out += "speed    mean " + in_prefixed(summary.mean_speed_m_s, "m/s") + ", max " +
         in_prefixed(summary.max_speed_m_s, "m/s") + "\n";
  out += "quality  mean ZNCC " + with_unit(summary.mean_zncc, 4, "") + ", median Q " +
         with_unit(summary.median_q, 2, "") + "\n";
  if (summary.static_share > kDirtyShare) {
    out += "optics   " + with_unit(100.0 * summary.static_share, 0, " %") +
           " of the image does not move with the ground: clean them, distances may be short\n";
  }
  if (summary.interrupted)
    out += "The run was interrupted: frames after the last one are missing.\n";
  return out;
}

}  // namespace lsv
