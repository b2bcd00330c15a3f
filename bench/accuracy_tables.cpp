// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_tables.h"

#include <algorithm>
#include <cmath>

#include "bench/accuracy_limits.h"
#include "bench/accuracy_text.h"
#include "lsv/output/number_text.h"

namespace lsv::bench {
namespace {

using Cells = std::vector<std::string>;

std::string row(const Cells& cells) {
  std::string out = "|";
  for (const std::string& cell : cells) out.append(" ").append(cell).append(" |");
  out += '\n';
  return out;
}

std::string head(const Cells& cells) {
  std::string out = row(cells);
  out += '|';
  for (std::size_t k = 0; k < cells.size(); ++k) out += "---|";
  out += '\n';
  return out;
}

std::string size_cell(int size) { return formatted("%g", kSpeckleSizes_px[size]); }
std::string mpx_cell(double value_px) { return three_digits(value_px * 1e3); }

std::string rmse_cell(const Errors& errors) {
  const double percent = errors.outlier_ratio() * 100.0;
  if (errors.fails()) return formatted("fails (%.0f %% out)", percent);
  const std::string rmse = three_digits(errors.rmse_px() * 1e3);
  return errors.outliers() == 0 ? rmse : rmse + formatted(" (%.1f %% out)", percent);
}

std::string limit_cell(const std::optional<double>& limit_mpx, double rmse_mpx) {
  if (!limit_mpx) return "-";
  return three_digits(*limit_mpx) + (rmse_mpx <= *limit_mpx ? " held" : " **missed**");
}

std::string percent_cell(const Errors& errors, double share) {
  return errors.has_sigma() ? formatted("%.1f", share * 100.0) : "-";
}

std::string method_row(const AccuracyResults& results, const CaseResult& result,
                       const MethodErrors& entry) {
  const Errors& e = entry.errors;
  const double rmse_mpx = e.rmse_px() * 1e3;
  const std::string_view condition = result.condition->name;
  return row({std::string(condition), size_cell(result.size), mpx_cell(e.rmse_px()),
              mpx_cell(result.bound_px), three_digits(e.rmse_px() / result.bound_px),
              mpx_cell(e.bias_x_px()), mpx_cell(e.bias_y_px()), mpx_cell(e.max_px()),
              std::to_string(e.outliers()), percent_cell(e, e.within_1_sigma()),
              percent_cell(e, e.within_196_sigma()),
              limit_cell(must_rmse_mpx(entry.method, condition, result.size), rmse_mpx),
              limit_cell(aim_rmse_mpx(results, entry.method, result), rmse_mpx)});
}

}  // namespace

std::string conditions_table() {
  std::string out = head({"condition", "what", "shifts"});
  for (const Condition& condition : conditions()) {
    const std::string shifts = condition.law == ShiftLaw::circle
                                   ? formatted("%g px in any direction", condition.range_px)
                                   : formatted("+-%g px per axis, uniform", condition.range_px);
    out += row({std::string(condition.name), std::string(condition.meaning), shifts});
  }
  return out;
}

std::string rmse_table(const AccuracyResults& results, int size) {
  Cells names = {"condition", "bound"};
  std::string rows;
  for (const CaseResult& result : results.cases) {
    if (result.size != size) continue;
    Cells cells = {std::string(result.condition->name), mpx_cell(result.bound_px)};
    for (const MethodErrors& entry : result.methods) {
      if (rows.empty()) names.emplace_back(entry.method);
      cells.push_back(rmse_cell(entry.errors));
    }
    rows += row(cells);
  }
  return head(names) + rows;
}

std::string method_table(const AccuracyResults& results, std::string_view method) {
  std::string out =
      head({"condition", "speckle px", "RMSE", "bound", "RMSE / bound", "bias x", "bias y", "max",
            "outliers", "within 1 sigma %", "within 1.96 sigma %", "Must RMSE", "Aim RMSE"});
  for (const CaseResult& result : results.cases)
    for (const MethodErrors& entry : result.methods)
      if (entry.method == method) out += method_row(results, result, entry);
  return out;
}

std::string s_curve_table(const AccuracyResults& results) {
  std::string out = head({"method", "speckle px", "largest bias, mpx", "standard error, mpx"});
  for (const SCurve& curve : results.s_curves) {
    double bias_px = 0.0;
    double error_px = 0.0;
    for (const double value : curve.bias_px) bias_px = std::max(bias_px, std::abs(value));
    for (const double value : curve.standard_error_px) error_px = std::max(error_px, value);
    out += row(
        {std::string(curve.method), size_cell(curve.size), mpx_cell(bias_px), mpx_cell(error_px)});
  }
  return out;
}

std::string drift_table(const AccuracyResults& results) {
  std::string out = head({"speckle px", "px per frame", "distance px", "precise, error %",
                          "refused", "classic, error %", "refused"});
  for (const DriftResult& drift : results.drifts) {
    out += row({formatted("%g", drift.speckle_px), formatted("%g", drift.speed_px_per_frame),
                formatted("%g", drift.speed_px_per_frame * drift.frames),
                formatted("%.5f", drift.precise_error_ratio * 100.0),
                std::to_string(drift.precise_refused),
                formatted("%.5f", drift.classic_error_ratio * 100.0),
                std::to_string(drift.classic_refused)});
  }
  return out;
}

}  // namespace lsv::bench
