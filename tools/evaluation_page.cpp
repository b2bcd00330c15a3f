// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluation_page.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "lsv/output/number_text.h"
#include "lsv/output/svg.h"
#include "tools/html_page.h"
#include "tools/xy_plot.h"

namespace lsv::cli {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMm = 1e3;
constexpr double kPercent = 100.0;
constexpr int kMapWidth_px = 900;
constexpr int kMapHeight_px = 560;
constexpr int kPlotWidth_px = 900;
constexpr int kPlotHeight_px = 300;

// Far apart in hue and in brightness, on white and on black.
constexpr std::string_view kTruthColour = "#2f80ed";
constexpr std::string_view kEstimateColour = "#d9542b";
constexpr std::string_view kRawColour = "#b8860b";

std::vector<Point> places(const std::vector<TrajectoryPose>& poses) {
  std::vector<Point> out;
  for (const TrajectoryPose& pose : poses) out.push_back({pose.x_m, pose.y_m});
  return out;
}

XyPlot map_of(const EvaluationReport& report) {
  const bool is_aligned = report.options.align != AlignmentKind::none;
  XyPlot out{.title = "Trajectories",
             .x_name = "x, m",
             .y_name = "y, m",
             .series = {{.name = "truth",
                         .colour = kTruthColour,
                         .points = places(report.truth.file.trajectory.poses)}},
             .patches = {},
             .has_equal_axes = true};
  out.series.push_back({.name = is_aligned ? "estimate, aligned" : "estimate",
                        .colour = kEstimateColour,
                        .points = places(report.result.pairs.estimate)});
  if (is_aligned) {
    out.series.push_back({.name = "estimate as it is",
                          .colour = kRawColour,
                          .points = places(report.estimate.file.trajectory.poses),
                          .mark = XyMark::dashed});
  }
  return out;
}

std::string curve(const char* title, const char* x_name, const char* y_name,
                  std::vector<Point> points, XyMark mark = XyMark::line) {
  const XyPlot plot{.title = title,
                    .x_name = x_name,
                    .y_name = y_name,
                    .series = {{.name = "",
                                .colour = kEstimateColour,
                                .points = std::move(points),
                                .mark = mark}},
                    .patches = {},
                    .includes_zero_y = true};
  return "<figure>" + draw(plot, kPlotWidth_px, kPlotHeight_px) + "</figure>\n";
}

std::vector<Point> along(const std::vector<double>& way_m, const std::vector<double>& values,
                         double unit) {
  std::vector<Point> out;
  for (std::size_t i = 0; i < way_m.size(); ++i) out.push_back({way_m[i], unit * values[i]});
  return out;
}

std::string row(const std::string& name, const ErrorStatistics& errors, double unit, int decimals) {
  if (errors.count == 0) return {};
  std::string out = "<tr><td>" + escaped(name) + "</td>";
  for (const double value : {errors.rmse, errors.mean, errors.median, errors.max, errors.sd})
    out += "<td>" + formatted("%.*f", decimals, unit * value) + "</td>";
  return out + "</tr>\n";
}

std::string table(const TrajectoryEvaluation& result) {
  std::string out =
      "<div "
      "class=\"scroll\"><table><tr><th></th><th>rmse</th><th>mean</th><th>median</th><th>max</"
      "th><th>sd</th></tr>\n";
  out += row("ATE, mm", result.position_m, kMm, 3);
  out += row("rotation, deg", result.rotation_rad, kDegrees, 4);
  out += row("heading, deg", result.heading_rad, kDegrees, 4);
  out +=
      row(formatted("RPE over %g m, mm", result.rpe_m.length), result.rpe_m.translation_m, kMm, 3);
  out += row("its rotation, deg", result.rpe_m.rotation_rad, kDegrees, 4);
  out +=
      row(formatted("RPE over %g s, mm", result.rpe_s.length), result.rpe_s.translation_m, kMm, 3);
  out += row("its rotation, deg", result.rpe_s.rotation_rad, kDegrees, 4);
  return out + "</table></div>\n";
}

std::string alignments(const TrajectoryEvaluation& result) {
  std::string out =
      "<h2>ATE by alignment</h2>\n<table><tr><th>alignment</th><th>rmse, mm</th></tr>\n";
  for (std::size_t i = 0; i < kAllAlignmentKinds.size(); ++i) {
    const bool is_chosen = kAllAlignmentKinds[i] == result.alignment.kind;
    out += std::string(is_chosen ? "<tr class=\"best\">" : "<tr>") + "<td>" +
           std::string(word(kAllAlignmentKinds[i])) + "</td><td>" +
           formatted("%.3f", kMm * result.ate_rmse_by_alignment_m[i]) + "</td></tr>\n";
  }
  return out +
         "</table>\n<p class=\"note\">The same pair of trajectories. Marked: the one that all "
         "other "
         "figures of this page are about.</p>\n";
}

std::string tile(const std::string& figure, const std::string& words) {
  return "<div><b>" + figure + "</b>" + escaped(words) + "</div>\n";
}

std::string tiles(const TrajectoryEvaluation& result) {
  std::string out = "<div class=\"tiles\">\n";
  out += tile(formatted("%.3g mm", kMm * result.position_m.rmse), "ATE, rmse");
  if (std::isfinite(result.drift_percent))
    out += tile(formatted("%.3g %%", result.drift_percent), "drift of the distance");
  if (std::isfinite(result.heading_rad.rmse))
    out += tile(formatted("%.3g deg", kDegrees * result.heading_rad.rmse), "heading, rmse");
  const NeesSummary& nees = result.position_nees;
  if (nees.count > 0) {
    out += tile(formatted("%.2f", nees.mean), "NEES of the position, 2 is right");
    out += tile(formatted("%.1f %%", kPercent * nees.share_inside_95), "within the 95 % ellipse");
  }
  return out + "</div>\n";
}

std::string drift_plot(const TrajectoryEvaluation& result) {
  if (result.drift.empty()) return {};
  std::vector<Point> points;
  for (const SegmentSummary& segment : result.drift)
    points.push_back({segment.length, kMm * segment.translation_m.rmse});
  return curve("RPE over the length of the segment", "length, m", "rmse, mm", std::move(points));
}

std::string settings(const EvaluationReport& report) {
  const EvaluationOptions& options = report.options;
  std::string out = "<p class=\"note\">";
  if (!report.result.time_s.empty()) {
    out += formatted("Pairs within %g s, offset %g s; ", options.association.max_dt_s,
                     options.association.offset_s);
    if (std::isfinite(report.result.covered_share))
      out += formatted("%.1f %% of the time of the truth covered; ",
                       kPercent * report.result.covered_share);
  }
  return out + formatted("RPE over %g m and %g s.</p>\n", options.rpe_m, options.rpe_s);
}

std::string file_words(const char* name, const EvaluatedFile& input) {
  return std::string(name) + " " + escaped(input.path) + ", SHA-256 " +
         escaped(input.sha256.substr(0, 16)) +
         formatted(", %zu poses. ", input.file.trajectory.poses.size());
}

}  // namespace

std::string evaluation_html(const EvaluationReport& report) {
  const TrajectoryEvaluation& result = report.result;
  std::string out = "<h1>Trajectory against truth</h1>\n<p>" +
                    file_words("Estimate", report.estimate) + file_words("Truth", report.truth) +
                    formatted("%zu pairs, %.6g m.", result.pairs.size(), result.way_m.back()) +
                    "</p>\n<p>Alignment " + escaped(alignment_text(report)) + ".</p>\n";
  for (const std::string& warning : evaluation_warnings(report))
    out += "<p class=\"warning\">" + escaped(warning) + "</p>\n";
  out += settings(report);
  out += tiles(result) + "<figure>" + draw(map_of(report), kMapWidth_px, kMapHeight_px) +
         "</figure>\n" + table(result) + alignments(result);
  out += curve("Position error along the way", "distance, m", "error, mm",
               along(result.way_m, result.errors.position_m, kMm));
  if (result.pairs.has_rotation) {
    out += curve("Heading error along the way", "distance, m", "estimate less truth, deg",
                 along(result.way_m, result.errors.heading_rad, kDegrees));
  }
  out += drift_plot(result);
  return html_page("lsv evaluate", out);
}

}  // namespace lsv::cli
