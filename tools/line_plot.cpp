// SPDX-License-Identifier: BSD-3-Clause
#include "tools/line_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lsv/output/number_text.h"

namespace lsv::cli {
namespace {

constexpr double kLeft_px = 62.0;
constexpr double kRight_px = 14.0;
constexpr double kTop_px = 48.0;
constexpr double kBottom_px = 46.0;
constexpr double kCharacter_px = 7.0;  // of a legend, about
constexpr std::string_view kHere = "#d9542b";

struct Axis {
  AxisScale scale = AxisScale::linear;
  double low = 0.0, high = 1.0;  // values
  double from_px = 0.0, to_px = 1.0;

  double px(double value) const {
    const double held = std::clamp(value, low, high);
    const double ratio = scale == AxisScale::logarithmic
                             ? std::log(held / low) / std::log(high / low)
                             : (held - low) / (high - low);
    return from_px + ratio * (to_px - from_px);
  }
};

/// 1, 2 and 5 times powers of ten, from the one not above `low` to the one not below `high`.
std::vector<double> steps_around(double low, double high) {
  std::vector<double> out;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade <= high; decade *= 10.0)
    for (const double step : {1.0, 2.0, 5.0}) out.push_back(step * decade);
  out.push_back(10.0 * out[out.size() - 3]);
  const auto first = std::upper_bound(out.begin(), out.end(), low * (1.0 + 1e-9)) - 1;
  const auto last = std::lower_bound(out.begin(), out.end(), high * (1.0 - 1e-9));
  return {first, last + 1};
}

/// Of all points that can be drawn; empty when there is none.
std::vector<double> y_steps(const LinePlot& plot) {
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  const auto cover = [&](double y) {
    if (!(y > 0.0)) return;
    low = std::min(low, y);
    high = std::max(high, y);
  };
  for (const LineSeries& series : plot.series)
    for (const Point& point : series.points) cover(point.y);
  if (plot.here) cover(plot.here->y);
  return high > 0.0 ? steps_around(low, high) : std::vector<double>{};
}

void draw_series(Svg& svg, const LineSeries& series, const Axis& x, const Axis& y) {
  std::vector<Point> run;
  const auto end_run = [&] {
    if (run.size() > 1) svg.polyline(run, series.colour, 2.0);
    run.clear();
  };
  for (const Point& point : series.points) {
    if (!(point.y > 0.0)) {
      end_run();
      continue;
    }
    const Point at{x.px(point.x), y.px(point.y)};
    if (series.is_marked)
      svg.marker(Marker::circle, at, 3.5, series.colour);
    else
      run.push_back(at);
  }
  end_run();
}

void draw_legend(Svg& svg, const LinePlot& plot) {
  double left = kLeft_px;
  for (const LineSeries& series : plot.series) {
    const double y = 33.0;
    if (series.is_marked)
      svg.marker(Marker::circle, {left + 8.0, y}, 3.5, series.colour);
    else
      svg.line({left, y}, {left + 16.0, y}, series.colour, 2.0);
    svg.label({left + 21.0, y + 4.0}, series.name, Anchor::start, 11.0);
    left += 38.0 + kCharacter_px * static_cast<double>(series.name.size());
  }
}

}  // namespace

std::string draw(const LinePlot& plot, int width, int height) {
  Svg svg(width, height, plot.title);
  svg.label({kLeft_px, 16.0}, plot.title, Anchor::start, 13.0);
  const double right = width - kRight_px;
  const double bottom = height - kBottom_px;
  const std::vector<double> steps = y_steps(plot);
  if (steps.size() < 2) {
    svg.label({0.5 * width, 0.5 * height}, "nothing can be predicted here", Anchor::middle);
    return svg.str();
  }
  const Axis x{plot.x_scale, plot.x_ticks.front(), plot.x_ticks.back(), kLeft_px, right};
  const Axis y{AxisScale::logarithmic, steps.front(), steps.back(), bottom, kTop_px};
  for (const double step : steps) {
    svg.line({kLeft_px, y.px(step)}, {right, y.px(step)}, kFaint);
    svg.label({kLeft_px - 6.0, y.px(step) + 4.0}, formatted("%g", step), Anchor::end, 11.0);
  }
  for (const double tick : plot.x_ticks) {
    svg.line({x.px(tick), kTop_px}, {x.px(tick), bottom}, kFaint);
    svg.label({x.px(tick), bottom + 16.0}, formatted("%g", tick), Anchor::middle, 11.0);
  }
  svg.line({kLeft_px, bottom}, {right, bottom}, kInk);
  svg.line({kLeft_px, kTop_px}, {kLeft_px, bottom}, kInk);
  svg.label({0.5 * (kLeft_px + right), height - 8.0}, plot.x_name, Anchor::middle);
  svg.upright_label({14.0, 0.5 * (kTop_px + bottom)}, plot.y_name);
  draw_legend(svg, plot);
  for (const LineSeries& series : plot.series) draw_series(svg, series, x, y);
  if (plot.here && plot.here->y > 0.0) {
    const Point at{x.px(plot.here->x), y.px(plot.here->y)};
    svg.line({at.x, bottom}, at, kHere, 1.0, true);
    svg.marker(Marker::circle, at, 5.0, kHere);
  }
  return svg.str();
}

}  // namespace lsv::cli
