// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/csv_sink.h"

#include <cmath>
#include <utility>

#include "lsv/output/number_text.h"
#include "lsv/output/run_settings.h"

namespace lsv {
namespace {

constexpr int kPixelDecimals = 6;
constexpr int kZnccDecimals = 6;
constexpr int kQDecimals = 4;
constexpr int kMetricDecimals = 9;
// At a few frames a second a sigma is nanometres a second; 0 would be none.
constexpr int kSigmaDecimals = 12;

std::string comment(std::string_view key, std::string_view value) {
  std::string line = "# ";
  line += key;
  line += ": ";
  line += value;
  line += '\n';
  return line;
}

std::string head_of(const RunInfo& info) {
  std::string head;
  for (const Setting& setting : run_settings(info))
    head += comment(setting.key, value_text(setting));
  head += comment("units", kUnits);
  head += comment("sign_convention", kSignConvention);
  head += kCsvHeader;
  head += '\n';
  return head;
}

void append_cell(std::string& row, double value, int decimals) {
  row += ',';
  append_fixed(row, value, decimals);
}

void append_row(std::string& row, const StepReport& report) {
  // Every number of a refused shift is empty, the measured quality too.
  const bool ok = report.shift.status == ShiftStatus::ok;
  const auto cell = [&row, ok](double value, int decimals) {
    append_cell(row, ok ? value : kUnknown, decimals);
  };
  const Shift& shift = report.shift;
  append_integer(row, report.frame);
  row += ',';
  append_seconds(row, report.stamp.ns);
  row += ',';
  append_seconds(row, report.dt_ns);
  cell(shift.dx_px, kPixelDecimals);
  cell(shift.dy_px, kPixelDecimals);
  cell(std::sqrt(shift.cov.xx_px2), kPixelDecimals);
  cell(std::sqrt(shift.cov.yy_px2), kPixelDecimals);
  cell(shift.quality.zncc, kZnccDecimals);
  cell(shift.quality.q, kQDecimals);
  row += ',';
  row += word(shift.status);
  cell(report.velocity.vx_m_s, kMetricDecimals);
  cell(report.velocity.vy_m_s, kMetricDecimals);
  cell(report.position.x_m, kMetricDecimals);
  cell(report.position.y_m, kMetricDecimals);
  cell(report.velocity.sigma_vx_m_s, kSigmaDecimals);
  cell(report.velocity.sigma_vy_m_s, kSigmaDecimals);
  row += ',';
  if (ok && report.motion != MotionState::unknown) row += word(report.motion);
  row += '\n';
}

}  // namespace

CsvSink::CsvSink(OutputFile file, const RunInfo& info)
    : file_(std::move(file)), head_(head_of(info)) {}

Result<void> CsvSink::write(const StepReport& report) {
  if (auto written = write_head(); !written) return written;
  if (report.shift.status == ShiftStatus::first_frame) return {};
  row_.clear();
  append_row(row_, report);
  return file_.write(row_);
}

Result<void> CsvSink::finish(const RunEnd& end) {
  if (auto written = write_head(); !written) return written;
  if (end.interrupted) {
    if (auto written = file_.write(comment("interrupted", "true")); !written) return written;
  }
  return file_.complete();
}

Result<void> CsvSink::write_head() {
  if (head_.empty()) return {};
  return file_.write(std::exchange(head_, {}));
}

}  // namespace lsv
