// SPDX-License-Identifier: BSD-3-Clause
// The report of `lsv calibrate noise` as a page that needs no network.
#include <cmath>

#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/output/number_text.h"
#include "lsv/output/svg.h"
#include "tools/html_page.h"
#include "tools/line_plot.h"
#include "tools/noise_report.h"

namespace lsv::cli {
namespace {

constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;
constexpr std::string_view kBlue = "#2f80ed";
constexpr std::string_view kTeal = "#2bb3a3";
constexpr int kPlotWidth = 460;
constexpr int kPlotHeight = 300;

std::string figure(double value) {
  return std::isfinite(value) ? formatted("%.3g", value) : std::string("-");
}

std::string row(const std::vector<std::string>& cells, const char* tag = "td",
                const char* kind = "") {
  std::string out = std::string("<tr") + kind + ">";
  for (const std::string& cell : cells)
    out += std::string("<") + tag + ">" + escaped(cell) + "</" + tag + ">";
  return out + "</tr>\n";
}

std::string big(const std::string& value, const std::string& meaning) {
  return "<div><b>" + escaped(value) + "</b><span class=\"note\">" + escaped(meaning) +
         "</span></div>\n";
}

std::string set_up(const NoiseReport& r) {
  const NoiseConditions& c = r.input.conditions;
  std::string out = formatted(
      "<p>%d x %d px, %d bit, %.6g Hz, exposed for %.4g us; speckle of %.3g px; %.5g mm/s along x "
      "moves the pattern %.4g px per frame and %.3g px while exposed; mean signal %.4g of %.4g "
      "counts, camera noise %.3g counts, ",
      c.width_px, c.height_px, c.bit_depth, r.input.rate_hz, r.input.exposure_s * kMicro,
      c.speckle_px, r.input.speed_m_s * kMilli, c.shift_px, c.blur_px, c.mean_signal_counts,
      full_scale_counts(c.bit_depth) - c.dark_counts, c.noise_sd_counts);
  out += std::isinf(c.electrons_per_count)
             ? std::string("no shot noise")
             : formatted("%.4g electrons per count", c.electrons_per_count);
  out += formatted("; correlation from frame to frame %.6g", c.rho);
  return out + (c.rho == 1.0 ? " (--rho: real ground is worse).</p>\n" : ".</p>\n");
}

std::string sigma_table(const NoiseReport& r) {
  const NoisePrediction& p = r.pair;
  const TrackingNoise& t = r.tracking;
  const auto line = [](const char* name, double x, double y) {
    return row({name, figure(x), figure(y)});
  };
  std::string out = "<table>" + row({"", "along x", "along y"}, "th");
  out += line("noise of the pixels, mpx", p.x.noise_px * kMilli, p.y.noise_px * kMilli);
  out += line("change of the pattern, mpx", p.x.boiling_px * kMilli, p.y.boiling_px * kMilli);
  out += line("clipped pixels, mpx", p.x.clipping_px * kMilli, p.y.clipping_px * kMilli);
  out += line("interpolation, mpx", p.x.interpolation_px * kMilli, p.y.interpolation_px * kMilli);
  out += line("sigma of one shift, mpx", p.sigma_x_px * kMilli, p.sigma_y_px * kMilli);
  out += line("its velocity, mm/s", velocity_sigma_m_s(r.scale_x, p.sigma_x_px) * kMilli,
              velocity_sigma_m_s(r.scale_y, p.sigma_y_px) * kMilli);
  out += line("in steady tracking, from frame to frame, mpx", t.step_x_px * kMilli,
              t.step_y_px * kMilli);
  out += line("its velocity, mm/s", velocity_sigma_m_s(r.scale_x, t.step_x_px) * kMilli,
              velocity_sigma_m_s(r.scale_y, t.step_y_px) * kMilli);
  return out + "</table>\n";
}

std::string plot(const NoiseSweep& sweep, double sigma_here_px) {
  LinePlot out;
  out.title = "sigma against " + std::string(sweep.name);
  out.x_name = sweep.name;
  out.y_name = "sigma of one shift, mpx";
  out.x_scale = sweep.is_logarithmic ? AxisScale::logarithmic : AxisScale::linear;
  for (const NoiseSweep::At& at : sweep.table) out.x_ticks.push_back(at.value);
  out.series = {{.name = "along the motion", .colour = kBlue, .points = {}},
                {.name = "across", .colour = kTeal, .points = {}}};
  for (const NoiseSweep::At& at : sweep.curve) {
    out.series[0].points.push_back({at.value, at.sigma_x_px * kMilli});
    out.series[1].points.push_back({at.value, at.sigma_y_px * kMilli});
  }
  if (std::isfinite(sigma_here_px)) out.here = Point{sweep.given, sigma_here_px * kMilli};
  return draw(out, kPlotWidth, kPlotHeight);
}

std::string choice_table(const NoiseReport& r) {
  std::string out =
      "<div class=\"scroll\"><table>" +
      row({"window, px", "rate, Hz", "exposure, us", "shift, px", "blur, px", "signal, counts",
           formatted("velocity over %.4g ms, mm/s", kMilli / r.input.update_hz),
           "position after 1 m, um", "pixels, 1e6/s"},
          "th");
  for (const WindowChoice& window : r.recommendation.windows) {
    if (!window.best) {
      out += formatted("<tr class=\"note\"><td>%d</td><td colspan=\"8\" style=\"text-align:left\">",
                       window.window_px) +
             escaped(advice(window.limit)) + "</td></tr>\n";
      continue;
    }
    const Choice& c = *window.best;
    const bool is_best = r.recommendation.best && r.recommendation.best->window_px == c.window_px;
    out += row({formatted("%d", c.window_px), formatted("%.5g", c.rate_hz),
                formatted("%.4g", c.exposure_s * kMicro), figure(c.shift_px), figure(c.blur_px),
                figure(c.mean_signal_counts), figure(c.update_sigma_m_s * kMilli),
                figure(c.distance_sigma_m * kMicro),
                figure(c.rate_hz * c.window_px * c.window_px / kMicro)},
               "td", is_best ? " class=\"best\"" : "");
  }
  return out + "</table></div>\n";
}

std::string choice(const NoiseReport& r) {
  std::string out = formatted("<h2>Which window, rate and exposure for %.5g mm/s?</h2>\n",
                              r.input.speed_m_s * kMilli);
  if (r.recommendation.best) {
    const Choice& best = *r.recommendation.best;
    out += "<div class=\"tiles\">\n" +
           big(formatted("%d x %d px", best.window_px, best.window_px), "window") +
           big(formatted("%.5g Hz", best.rate_hz), "frame rate") +
           big(formatted("%.4g us", best.exposure_s * kMicro), "exposure") +
           big(formatted("%.3g mm/s", best.update_sigma_m_s * kMilli),
               formatted("sigma of the velocity over %.4g ms", kMilli / r.input.update_hz)) +
           "</div>\n<ul>\n";
    for (const std::string& reason : r.reasons) out += "<li>" + escaped(reason) + "</li>\n";
    out += "</ul>\n";
  }
  return out + choice_table(r) +
         "<p class=\"note\">The best rate and exposure of each window. Rates compare over equal "
         "times: a faster camera averages more frames. Of choices within 5 % of each other the one "
         "with the fewest pixels per second is taken.</p>\n";
}

}  // namespace

std::string noise_html(const NoiseReport& r) {
  std::string out =
      "<h1>Noise of " + escaped(r.input.calibration.sensor_name) + "</h1>\n" + set_up(r);
  for (const std::string& warning : r.warnings)
    out += "<p class=\"warning\">" + escaped(warning) + "</p>\n";
  out += "<div class=\"tiles\">\n" +
         big(figure(r.pair.sigma_x_px * kMilli) + " mpx", "sigma of one shift along x") +
         big(figure(velocity_sigma_m_s(r.scale_x, r.pair.sigma_x_px) * kMilli) + " mm/s",
             "of its velocity") +
         big(figure(velocity_sigma_m_s(r.scale_x, r.tracking.step_x_px) * kMilli) + " mm/s",
             "in steady tracking, frame by frame") +
         big(figure(r.pair.zncc_sigmas),
             formatted("sigmas over chance (gate %g)", GateConfig{}.min_zncc_sigmas)) +
         "</div>\n" + sigma_table(r);
  out +=
      "<p class=\"note\">1 mpx = 0.001 px. One shift: two frames, preset precise. Random errors "
      "only: the sigma of the scale is not in them.</p>\n" +
      choice(r) + "<h2>What it depends on</h2>\n<div class=\"plots\">\n";
  for (const NoiseSweep& sweep : r.sweeps)
    out += "<figure style=\"margin:0\">" + plot(sweep, r.pair.sigma_x_px) + "</figure>\n";
  out +=
      "</div>\n<p class=\"note\">One figure changed, all others as given; marked: the set-up "
      "above. A line ends where nothing was simulated or frames would be refused. Model and "
      "check: docs/noise.md.</p>\n";
  return html_page("lsv calibrate noise", out);
}

}  // namespace lsv::cli
