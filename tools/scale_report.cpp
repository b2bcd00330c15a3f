// SPDX-License-Identifier: BSD-3-Clause
#include "tools/scale_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lsv/output/number_text.h"
#include "lsv/output/svg.h"
#include "tools/html_page.h"

namespace lsv::cli {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::string_view kBlue = "#2f80ed";
constexpr std::string_view kRed = "#d9542b";

struct Figure {
  const char* name;
  double value;
  double sigma;
  const char* unit;
};

std::array<Figure, 4> figures(const ScaleFit& fit) {
  const auto sigma = [&fit](std::size_t i) { return std::sqrt(fit.cov[i][i]); };
  return {{{"Sc along image x", fit.sc_x_ratio, sigma(0), ""},
           {"Sc along image y", fit.sc_y_ratio, sigma(1), ""},
           {"mounting angle", kDegrees * fit.orientation.angle_rad, kDegrees * sigma(2), " deg"},
           {"axis skew", kDegrees * fit.orientation.skew_rad, kDegrees * sigma(3), " deg"}}};
}

std::string in_sigmas(double value) {
  return std::isfinite(value) ? formatted("%+.1f", value) : std::string("unknown");
}

/// One line each: what a user must know before trusting the figures.
std::vector<std::string> remarks(const ScaleReport& report) {
  std::vector<std::string> out = report.warnings;
  if (report.fit.sigma_factor > 1.0) {
    out.push_back(
        formatted("the residuals are %.1f times what the sigmas allow: all sigmas were "
                  "raised by that; look for a bad run among the residuals",
                  report.fit.sigma_factor));
  }
  constexpr double kBadRun_sigmas = 4.0;
  for (const ScaleResidual& run : report.fit.residuals) {
    const double worst = std::max(std::abs(run.left_out_x_sigmas), std::abs(run.left_out_y_sigmas));
    if (worst > kBadRun_sigmas) {
      out.push_back(run.name + formatted(": the other runs contradict it by %.1f sigma", worst));
    }
  }
  return out;
}

std::string run_row(const ScaleResidual& r) {
  return formatted("%+10.1f %+10.1f %9.1f %9s %9s", 1e6 * r.x_m, 1e6 * r.y_m, 1e6 * r.sigma_x_m,
                   in_sigmas(r.left_out_x_sigmas).c_str(), in_sigmas(r.left_out_y_sigmas).c_str());
}

/// Where the runs lead, with the residuals a thousand times as long.
std::string runs_svg(const ScaleReport& report) {
  constexpr int kSide = 380;
  constexpr double kHalf = 0.5 * kSide;
  constexpr double kMagnified = 1000.0;
  double reach_m = 0.0;
  for (const ScaleRun& run : report.runs) {
    const ScalePoint& end = run.points.back();
    const ScalePoint& begin = run.points.front();
    const bool series = run.points.size() > 1;
    reach_m = std::max(reach_m, std::hypot(end.x_m - (series ? begin.x_m : 0.0),
                                           end.y_m - (series ? begin.y_m : 0.0)));
  }
  Svg svg(kSide, kSide, "runs and their residuals");
  const double per_m = 0.8 * kHalf / reach_m;
  svg.line({0.0, kHalf}, {kSide, kHalf}, kFaint);
  svg.line({kHalf, 0.0}, {kHalf, kSide}, kFaint);
  svg.label({kSide - 4.0, kHalf - 5.0}, "x", Anchor::end);
  svg.label({kHalf + 5.0, 12.0}, "y");
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    const ScaleRun& run = report.runs[i];
    const bool series = run.points.size() > 1;
    const double x_m = run.points.back().x_m - (series ? run.points.front().x_m : 0.0);
    const double y_m = run.points.back().y_m - (series ? run.points.front().y_m : 0.0);
    const Point end{kHalf + per_m * x_m, kHalf - per_m * y_m};
    const ScaleResidual& r = report.fit.residuals[i];
    svg.line({kHalf, kHalf}, end, kInk);
    svg.marker(Marker::circle, end, 3.0, kBlue);
    svg.line(end, {end.x + kMagnified * per_m * r.x_m, end.y - kMagnified * per_m * r.y_m}, kRed,
             2.0);
  }
  svg.label({6.0, kSide - 8.0},
            formatted("largest travel %.4g mm, residuals (red) x 1000", 1e3 * reach_m));
  return svg.str();
}

/// Residual of each run in its own sigmas, with the band of +-2.
std::string residuals_svg(const ScaleReport& report) {
  constexpr double kLeft = 50.0, kTop = 12.0, kHeight = 220.0, kStep = 34.0, kRange = 5.0;
  const double width = kStep * static_cast<double>(report.fit.residuals.size());
  Svg svg(static_cast<int>(kLeft + width) + 20, static_cast<int>(kTop + kHeight) + 50,
          "residuals in sigmas");
  const auto y_of = [&](double sigmas) {
    return kTop + 0.5 * kHeight * (1.0 - std::clamp(sigmas, -kRange, kRange) / kRange);
  };
  svg.rect({kLeft, y_of(2.0)}, width, y_of(-2.0) - y_of(2.0), kInk, 0.15);
  for (const double tick : {-4.0, -2.0, 0.0, 2.0, 4.0}) {
    svg.line({kLeft, y_of(tick)}, {kLeft + width, y_of(tick)}, kFaint);
    svg.label({kLeft - 6.0, y_of(tick) + 4.0}, formatted("%+.0f", tick), Anchor::end);
  }
  svg.upright_label({14.0, kTop + 0.5 * kHeight}, "residual, sigma");
  for (std::size_t i = 0; i < report.fit.residuals.size(); ++i) {
    const ScaleResidual& r = report.fit.residuals[i];
    const double at = kLeft + kStep * (static_cast<double>(i) + 0.5);
    svg.marker(Marker::circle, {at - 4.0, y_of(r.x_m / r.sigma_x_m)}, 4.0, kBlue);
    svg.marker(Marker::square, {at + 4.0, y_of(r.y_m / r.sigma_y_m)}, 4.0, kRed);
    svg.label({at, kTop + kHeight + 16.0}, formatted("%zu", i + 1), Anchor::middle);
  }
  svg.marker(Marker::circle, {kLeft + 6.0, kTop + kHeight + 34.0}, 4.0, kBlue);
  svg.label({kLeft + 14.0, kTop + kHeight + 38.0}, "x");
  svg.marker(Marker::square, {kLeft + 40.0, kTop + kHeight + 34.0}, 4.0, kRed);
  svg.label({kLeft + 48.0, kTop + kHeight + 38.0}, "y; run number below");
  return svg.str();
}

std::string cell(const std::string& words) { return "<td>" + escaped(words) + "</td>"; }

}  // namespace

std::string scale_text(const ScaleReport& report) {
  std::string out;
  for (const Figure& f : figures(report.fit))
    out += formatted("%-18s %.6f +- %.6f%s\n", f.name, f.value, f.sigma, f.unit);
  out += formatted(
      "%-18s %s\n", "image",
      report.fit.orientation.mirrored ? "mirrored against the reference axes" : "not mirrored");
  out += formatted("%-18s chi2 %.1f for %d degrees of freedom\n", "fit", report.fit.chi2,
                   report.fit.dof);
  if (report.change) {
    out += "against the calibration given, in sigmas of the difference:\n";
    const char* const names[] = {"Sc x", "Sc y", "angle", "skew"};
    for (std::size_t i = 0; i < 4; ++i) {
      const double d = report.change->difference[i];
      out += formatted("  %-6s %+.6f  %s\n", names[i], i < 2 ? d : kDegrees * d,
                       in_sigmas(report.change->sigmas[i]).c_str());
    }
  }
  out += "\n  residuals, um      x          y     sigma   left out: x, y in sigmas\n";
  for (std::size_t i = 0; i < report.fit.residuals.size(); ++i)
    out += formatted("  %2zu %-8.8s", i + 1, report.fit.residuals[i].name.c_str()) +
           run_row(report.fit.residuals[i]) + "\n";
  for (const std::string& remark : remarks(report)) out += "\nwarning: " + remark + "\n";
  return out;
}

std::string scale_html(const ScaleReport& report) {
  const ScaleRecord& record = *report.calibration.scale;
  std::string out = "<h1>Scale of " + escaped(report.calibration.sensor_name) + "</h1>\n<p>" +
                    escaped(record.date) + ", " + escaped(record.method) +
                    formatted(", height %.4g m. ", record.height_m) + "Inputs " +
                    escaped(record.inputs_sha256.substr(0, 16)) + ".</p>\n";
  for (const std::string& remark : remarks(report))
    out += "<p class=\"warning\">" + escaped(remark) + "</p>\n";
  out += "<table><tr><th>figure</th><th>value</th><th>sigma</th></tr>\n";
  for (const Figure& f : figures(report.fit)) {
    out += "<tr>" + cell(f.name) + cell(formatted("%.6f%s", f.value, f.unit)) +
           cell(formatted("%.6f%s", f.sigma, f.unit)) + "</tr>\n";
  }
  out += formatted("</table>\n<p>%s. chi2 %.1f for %d degrees of freedom.</p>\n",
                   report.fit.orientation.mirrored ? "The image is mirrored" : "Not mirrored",
                   report.fit.chi2, report.fit.dof);
  out += "<h2>Runs</h2>\n<figure>" + runs_svg(report) + "</figure>\n<figure>" +
         residuals_svg(report) + "</figure>\n";
  out +=
      "<table><tr><th>run</th><th>residual x, um</th><th>residual y, um</th><th>sigma x, um</th>"
      "<th>left out, x</th><th>left out, y</th></tr>\n";
  for (std::size_t i = 0; i < report.fit.residuals.size(); ++i) {
    const ScaleResidual& r = report.fit.residuals[i];
    out += "<tr>" + cell(formatted("%zu ", i + 1) + r.name) +
           cell(formatted("%+.1f", 1e6 * r.x_m)) + cell(formatted("%+.1f", 1e6 * r.y_m)) +
           cell(formatted("%.1f", 1e6 * r.sigma_x_m)) + cell(in_sigmas(r.left_out_x_sigmas)) +
           cell(in_sigmas(r.left_out_y_sigmas)) + "</tr>\n";
  }
  out +=
      "</table>\n<p>Residual: reference less fit at the end of a run. Left out: what the other "
      "runs "
      "say of it, in sigmas.</p>\n";
  return html_page("lsv calibrate scale", out);
}

}  // namespace lsv::cli
