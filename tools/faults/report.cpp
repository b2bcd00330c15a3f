// SPDX-License-Identifier: BSD-3-Clause
#include "tools/faults/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lsv::faults {
namespace {

constexpr std::size_t kBrokenShown = 4;  // of one fault

std::string number(const char* format, double value) {
  if (!std::isfinite(value)) return "-";
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

double percent(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? kUnknown : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

std::string line(const Row& row) {
  const Findings& all = row.all;
  std::string out = "| " + row.id + " | " + row.fault + " | ";
  out += row.detects ? number("%.4g", 100.0 * row.detected_ratio) : "-";
  out += " | " + number("%.3g", row.latency_median_ms) + " | " +
         number("%.3g", row.latency_p99_ms) + " | " + number("%.3g", row.recovery_max_frames) +
         " | " + number("%.3g", row.false_alarms_per_h) + " | " +
         number("%.4f", all.largest_error_px) + " (" + number("%.1f", all.largest_error_sigmas) +
         ") | " + std::to_string(all.silent_errors + all.lies) + " | " +
         number("%.3g", percent(all.good_frames - all.good_measured, all.good_frames)) + " | " +
         std::to_string(all.segments) + " | " +
         (row.broken_limits.empty() ? "holds" : "**broken**") + " |\n";
  return out;
}

}  // namespace

std::string table(const std::vector<Row>& rows) {
  std::string out =
      "| id | fault | told, % | median, ms | p99, ms | recovery, frames | false alarms per h | "
      "largest error called valid, px (sigma) | silent errors | good frames not measured, % | "
      "ground lost | limits |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) out += line(row);
  for (const Row& row : rows) {
    const std::size_t shown = std::min(row.broken_limits.size(), kBrokenShown);
    for (std::size_t i = 0; i < shown; ++i) out += "\n- " + row.id + ": " + row.broken_limits[i];
    if (const std::size_t more = row.broken_limits.size() - shown; more > 0)
      out += "\n- " + row.id + ": and " + std::to_string(more) + " more";
  }
  out += "\n";
  return out;
}

}  // namespace lsv::faults
