// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluation_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "lsv/output/number_text.h"

namespace lsv::cli {
namespace {

using nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMs = 1e3;
constexpr double kPercent = 100.0;
constexpr double kWellCovered = 0.95;  // of the time of the truth

ordered_json known(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

bool is_by_time(const EvaluationReport& report) {
  return report.estimate.file.trajectory.has_time && report.truth.file.trajectory.has_time;
}

bool is_fit(AlignmentKind kind) {
  return kind != AlignmentKind::none && kind != AlignmentKind::origin;
}

double turn_rad(const Alignment& alignment) {
  const Quaternion& q = alignment.rotation;
  return 2.0 * std::atan2(std::hypot(q.x, q.y, q.z), std::abs(q.w));
}

void add_file_warnings(const EvaluatedFile& input, std::vector<std::string>& out) {
  const TrajectoryFile& file = input.file;
  if (file.rows_skipped > 0) {
    out.push_back(input.path + formatted(": %zu rows without a pose were skipped, the first at "
                                         "line %zu",
                                         file.rows_skipped, file.first_skipped_line));
  }
}

void add_alignment_warnings(const EvaluationReport& report, std::vector<std::string>& out) {
  const Alignment& alignment = report.result.alignment;
  if (alignment.status == AlignmentStatus::free_turn)
    out.push_back("the poses tell no turn, so none was made: only the shift is aligned");
  if (alignment.status == AlignmentStatus::free_about_line)
    out.push_back("all positions are on one line: the turn about it is not known and left out");
  if (report.result.pairs.is_planar && rotation_matrix(alignment.rotation)[2][2] < 0.0) {
    out.push_back(
        "the alignment turns the plane over: an axis of the estimate is mirrored; se2 does not");
  }
  if (alignment.kind == AlignmentKind::se2 &&
      (report.estimate.file.format == TrajectoryFormat::kitti ||
       report.truth.file.format == TrajectoryFormat::kitti)) {
    out.push_back(
        "se2 turns about z, which in camera axes of KITTI points forward; se3 fits those");
  }
  if (alignment.kind == AlignmentKind::sim3 && alignment.scale != 1.0) {
    out.push_back(
        formatted("the scale of the estimate was changed by %+.3f %% before its errors "
                  "were taken",
                  kPercent * (alignment.scale - 1.0)));
  }
}

bool is_start_uncertain(const PosePairs& pairs) {
  const PlanarCovariance& cov = pairs.covariances.front();
  return cov.xx_m2 > 0.0 || cov.yy_m2 > 0.0 || cov.yawyaw_rad2 > 0.0;
}

void add_segment_warning(const SegmentSummary& summary, const char* unit, double there,
                         std::vector<std::string>& out) {
  if (summary.translation_m.count > 0 || std::isnan(there)) return;
  out.push_back(formatted("RPE: no segment of %g %s: there are %.3g %s, or poses too far apart",
                          summary.length, unit, there, unit));
}

std::string statistics_row(const char* name, const ErrorStatistics& errors, double unit) {
  if (errors.count == 0) return {};
  return formatted("%-20s %10.6f %10.6f %10.6f %10.6f %10.6f\n", name, unit * errors.rmse,
                   unit * errors.mean, unit * errors.median, unit * errors.max, unit * errors.sd);
}

std::string segment_rows(const SegmentSummary& summary, const char* unit) {
  const std::string name = formatted("RPE over %g %s, m", summary.length, unit);
  return statistics_row(name.c_str(), summary.translation_m, 1.0) +
         statistics_row("  its rotation, deg", summary.rotation_rad, kDegrees);
}

std::string file_line(const char* name, const EvaluatedFile& input) {
  return formatted("%-11s", name) + input.path + ": " + std::string(word(input.file.format)) +
         formatted(", %zu poses\n", input.file.trajectory.poses.size());
}

std::string nees_line(const char* name, const NeesSummary& nees) {
  if (nees.count == 0) return {};
  std::string out = formatted("%s %.3f (right: %d), %.1f %% of %zu within the 95 %% ellipse", name,
                              nees.mean, nees.dof, kPercent * nees.share_inside_95, nees.count);
  if (nees.left_out > 0)
    out += formatted("; %zu without a covariance that is one left out", nees.left_out);
  return out;
}

void add_statistics(ordered_json& to, const std::string& name, const std::string& unit,
                    const ErrorStatistics& errors) {
  to[name + "_rmse_" + unit] = known(errors.rmse);
  to[name + "_mean_" + unit] = known(errors.mean);
  to[name + "_median_" + unit] = known(errors.median);
  to[name + "_max_" + unit] = known(errors.max);
  to[name + "_sd_" + unit] = known(errors.sd);
}

ErrorStatistics in_degrees(ErrorStatistics errors) {
  for (double* value : {&errors.rmse, &errors.mean, &errors.median, &errors.max, &errors.sd})
    *value *= kDegrees;
  return errors;
}

void add_file(ordered_json& to, const std::string& name, const EvaluatedFile& input) {
  to[name] = input.path;
  to[name + "_sha256"] = input.sha256;
  to[name + "_format"] = word(input.file.format);
  to[name + "_poses"] = input.file.trajectory.poses.size();
  to[name + "_rows_skipped"] = input.file.rows_skipped;
}

void add_segments(ordered_json& to, const std::string& name, const SegmentSummary& summary) {
  to[name + "_pairs"] = summary.translation_m.count;
  add_statistics(to, name, "m", summary.translation_m);
  add_statistics(to, name + "_rotation", "deg", in_degrees(summary.rotation_rad));
}

void add_nees(ordered_json& to, const std::string& name, const NeesSummary& nees) {
  to[name + "_mean"] = known(nees.mean);
  to[name + "_dof"] = nees.count > 0 ? ordered_json(nees.dof) : ordered_json(nullptr);
  to[name + "_share_inside_95"] = known(nees.share_inside_95);
  to[name + "_poses"] = nees.count;
  to[name + "_left_out"] = nees.left_out;
}

double end_percent(const TrajectoryEvaluation& result) {
  const double way_m = result.way_m.back();
  return way_m > 0.0 ? kPercent * result.end_error_m / way_m : kUnknown;
}

double duration_s(const TrajectoryEvaluation& result) {
  return result.time_s.empty() ? kUnknown : result.time_s.back();
}

}  // namespace

std::vector<std::string> evaluation_warnings(const EvaluationReport& report) {
  std::vector<std::string> out;
  const TrajectoryEvaluation& result = report.result;
  add_file_warnings(report.estimate, out);
  add_file_warnings(report.truth, out);
  const std::size_t poses = std::min(report.estimate.file.trajectory.poses.size(),
                                     report.truth.file.trajectory.poses.size());
  if (2 * result.pairs.size() < poses) {
    out.push_back(formatted("only %zu of %zu poses have a partner within %g s", result.pairs.size(),
                            poses, report.options.association.max_dt_s));
  }
  if (result.covered_share < kWellCovered) {
    out.push_back(
        formatted("%.1f %% of the time of the truth is not covered by the estimate: the "
                  "figures are about the rest",
                  kPercent * (1.0 - result.covered_share)));
  }
  add_alignment_warnings(report, out);
  add_segment_warning(result.rpe_m, "m", result.way_m.back(), out);
  add_segment_warning(result.rpe_s, "s", duration_s(result), out);
  if (result.position_nees.count > 0 && is_fit(result.alignment.kind)) {
    out.push_back("NEES after a fit is too small: the fit has taken errors away; none does not");
  }
  if (result.position_nees.count > 0 && result.alignment.kind == AlignmentKind::origin &&
      is_start_uncertain(result.pairs)) {
    out.push_back(
        "NEES under origin is too large: it puts the error of the first pose, whose covariance is "
        "not zero, into all others; none does not");
  }
  return out;
}

std::string alignment_text(const EvaluationReport& report) {
  const Alignment& alignment = report.result.alignment;
  if (alignment.kind == AlignmentKind::none) return "none: the estimate as it is";
  const auto& [x_m, y_m, z_m] = alignment.translation_m;
  const bool is_upright = alignment.rotation.x == 0.0 && alignment.rotation.y == 0.0;
  std::string out(word(alignment.kind));
  out += is_upright
             ? formatted(": turn about z %+.4f deg", kDegrees * heading_rad(alignment.rotation))
             : formatted(": turn %.4f deg", kDegrees * turn_rad(alignment));
  out += formatted(", shift x %+.6f y %+.6f z %+.6f m", x_m, y_m, z_m);
  if (alignment.kind == AlignmentKind::sim3) out += formatted(", scale %.6f", alignment.scale);
  return out;
}

std::string evaluation_text(const EvaluationReport& report) {
  const TrajectoryEvaluation& result = report.result;
  std::string out = file_line("estimate", report.estimate) + file_line("truth", report.truth);
  out += formatted("pairs      %zu ", result.pairs.size());
  out += is_by_time(report)
             ? formatted("by time, stamps %.3g ms apart on average and at most %.3g ms\n",
                         kMs * result.pairs.mean_dt_s, kMs * result.pairs.max_dt_s)
             : std::string("by order\n");
  if (std::isfinite(result.covered_share))
    out +=
        formatted("covered    %.1f %% of the time of the truth\n", kPercent * result.covered_share);
  out += formatted("distance   %.6g m", result.way_m.back());
  out += result.time_s.empty() ? std::string("\n") : formatted(" in %.6g s\n", duration_s(result));
  out += "alignment  " + alignment_text(report) + "\n";
  out += std::string("compared   ") + (result.pairs.is_planar ? "in the plane: x, y" : "x, y, z") +
         (result.pairs.has_rotation ? " and rotation\n" : "; no rotation in both\n");
  out += formatted("\n%-20s %10s %10s %10s %10s %10s\n", "", "rmse", "mean", "median", "max", "sd");
  out += statistics_row("ATE, m", result.position_m, 1.0);
  out += statistics_row("rotation, deg", result.rotation_rad, kDegrees);
  out += statistics_row("heading, deg", result.heading_rad, kDegrees);
  out += segment_rows(result.rpe_m, "m") + segment_rows(result.rpe_s, "s");
  out += "\nATE rmse by alignment, m:";
  for (std::size_t i = 0; i < kAllAlignmentKinds.size(); ++i) {
    out += std::string(i > 0 ? ", " : " ") + std::string(word(kAllAlignmentKinds[i])) +
           formatted(" %.6g", result.ate_rmse_by_alignment_m[i]);
  }
  out += "\n";
  if (!result.drift.empty()) {
    out += formatted("drift      %.4f %% of the distance, over segments of %.3g to %.3g m\n",
                     result.drift_percent, result.drift.front().length, result.drift.back().length);
  }
  out += formatted("end        %.6f m off", result.end_error_m);
  out += std::isfinite(end_percent(result))
             ? formatted(", %.4f %% of the distance\n", end_percent(result))
             : std::string("\n");
  for (const std::string& line : {nees_line("NEES       of x, y:", result.position_nees),
                                  nees_line("NEES       of x, y, yaw:", result.pose_nees)}) {
    if (!line.empty()) out += line + "\n";
  }
  for (const std::string& warning : evaluation_warnings(report))
    out += "\nwarning: " + warning + "\n";
  return out;
}

std::string evaluation_json(const EvaluationReport& report) {
  const TrajectoryEvaluation& result = report.result;
  const Alignment& alignment = result.alignment;
  ordered_json out = {{"schema", "lsv.evaluation/1"}};
  add_file(out, "est", report.estimate);
  add_file(out, "truth", report.truth);
  out["association"] = is_by_time(report) ? "time" : "order";
  out["offset_s"] = report.options.association.offset_s;
  out["max_dt_s"] = report.options.association.max_dt_s;
  out["pairs"] = result.pairs.size();
  out["pair_dt_mean_s"] = known(result.pairs.mean_dt_s);
  out["pair_dt_max_s"] = known(result.pairs.max_dt_s);
  out["truth_covered_share"] = known(result.covered_share);
  out["planar"] = result.pairs.is_planar;
  out["distance_m"] = result.way_m.back();
  out["duration_s"] = known(duration_s(result));
  out["align"] = word(alignment.kind);
  out["alignment"] = {{"status", word(alignment.status)},
                      {"rotation", rotation_matrix(alignment.rotation)},
                      {"translation_m", alignment.translation_m},
                      {"scale", alignment.scale}};
  add_statistics(out, "ate", "m", result.position_m);
  for (std::size_t i = 0; i < kAllAlignmentKinds.size(); ++i) {
    out["ate_rmse_by_align_m"][std::string(word(kAllAlignmentKinds[i]))] =
        result.ate_rmse_by_alignment_m[i];
  }
  add_statistics(out, "ate_rotation", "deg", in_degrees(result.rotation_rad));
  add_statistics(out, "heading", "deg", in_degrees(result.heading_rad));
  out["rpe_of"] = result.pairs.has_rotation ? "motion" : "displacement";
  out["rpe_segment_m"] = report.options.rpe_m;
  add_segments(out, "rpe_per_m", result.rpe_m);
  out["rpe_segment_s"] = report.options.rpe_s;
  add_segments(out, "rpe_per_s", result.rpe_s);
  out["drift_percent"] = known(result.drift_percent);
  out["drift_segments"] = ordered_json::array();
  for (const SegmentSummary& segment : result.drift) {
    out["drift_segments"].push_back(
        {{"length_m", segment.length},
         {"pairs", segment.translation_m.count},
         {"mean_percent", kPercent * segment.mean_rate},
         {"rmse_m", segment.translation_m.rmse},
         {"rotation_rmse_deg", known(kDegrees * segment.rotation_rad.rmse)}});
  }
  out["end_error_m"] = result.end_error_m;
  out["end_error_percent"] = known(end_percent(result));
  add_nees(out, "nees_position", result.position_nees);
  add_nees(out, "nees_pose", result.pose_nees);
  out["warnings"] = evaluation_warnings(report);
  return out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace lsv::cli
