// SPDX-License-Identifier: BSD-3-Clause
#include "tools/xy_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lsv/output/number_text.h"

namespace lsv::cli {
namespace {

constexpr double kLeft_px = 72.0;
constexpr double kRight_px = 14.0;
constexpr double kTop_px = 48.0;
constexpr double kBottom_px = 46.0;
constexpr double kCharacter_px = 7.0;  // of a legend, about
constexpr std::size_t kMostPoints = 1500;

struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool is_empty() const { return !(low <= high); }
  double length() const { return high - low; }
  double middle() const { return 0.5 * (low + high); }
  void widen_to(double length) {
    const double centre = middle();
    low = centre - 0.5 * length;
    high = centre + 0.5 * length;
  }
};

struct LinearAxis {
  Span span;
  double from_px = 0.0, to_px = 1.0;

  double px(double value) const {
    return from_px + (value - span.low) / span.length() * (to_px - from_px);
  }
  std::vector<double> ticks() const {
    std::vector<double> out;
    const double step = nice_step(span.length());
    for (double i = std::ceil(span.low / step - 1e-9); i * step <= span.high + 1e-9 * step; ++i)
      out.push_back(i == 0.0 ? 0.0 : i * step);
    return out;
  }
};

struct Axes {
  LinearAxis x, y;
  Point at(Point p) const { return {x.px(p.x), y.px(p.y)}; }
};

/// Room around what is drawn; a span without length gets some.
void add_room(Span& span) {
  const double length = span.length();
  span.widen_to(length > 0.0 ? 1.06 * length : std::max(1e-3, 0.1 * std::abs(span.low)));
}

Axes axes_of(const XyPlot& plot, int width, int height) {
  Axes out;
  out.x.from_px = kLeft_px, out.x.to_px = width - kRight_px;
  out.y.from_px = height - kBottom_px, out.y.to_px = kTop_px;
  for (const XySeries& series : plot.series) {
    for (const Point& point : series.points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
      out.x.span.include(point.x);
      out.y.span.include(point.y);
    }
  }
  if (out.x.span.is_empty()) return out;
  if (plot.includes_zero_y) out.y.span.include(0.0);
  add_room(out.x.span);
  add_room(out.y.span);
  if (plot.has_equal_axes) {
    const double wide_px = out.x.to_px - out.x.from_px, tall_px = out.y.from_px - out.y.to_px;
    const double per_px = std::max(out.x.span.length() / wide_px, out.y.span.length() / tall_px);
    out.x.span.widen_to(per_px * wide_px);
    out.y.span.widen_to(per_px * tall_px);
  }
  return out;
}

void draw_patches(const XyPlot& plot, const Axes& axes, Svg& svg) {
  for (const XyPatch& patch : plot.patches) {
    const double left = std::max(patch.left, axes.x.span.low);
    const double right = std::min(patch.right, axes.x.span.high);
    const double bottom = std::max(patch.bottom, axes.y.span.low);
    const double top = std::min(patch.top, axes.y.span.high);
    if (!(left < right && bottom < top)) continue;
    const Point corner = axes.at({left, top}), opposite = axes.at({right, bottom});
    svg.rect(corner, opposite.x - corner.x, opposite.y - corner.y, patch.colour, 0.18);
    svg.label({corner.x + 5.0, corner.y + 14.0}, patch.name, Anchor::start, 11.0);
  }
}

void draw_grid(const XyPlot& plot, const Axes& axes, int width, int height, Svg& svg) {
  const double right = width - kRight_px, bottom = height - kBottom_px;
  for (const double tick : axes.y.ticks()) {
    const double y = axes.y.px(tick);
    svg.line({kLeft_px, y}, {right, y}, kFaint);
    svg.label({kLeft_px - 6.0, y + 4.0}, formatted("%g", tick), Anchor::end, 11.0);
  }
  for (const double tick : axes.x.ticks()) {
    const double x = axes.x.px(tick);
    svg.line({x, kTop_px}, {x, bottom}, kFaint);
    svg.label({x, bottom + 16.0}, formatted("%g", tick), Anchor::middle, 11.0);
  }
  svg.line({kLeft_px, bottom}, {right, bottom}, kInk);
  svg.line({kLeft_px, kTop_px}, {kLeft_px, bottom}, kInk);
  svg.label({0.5 * (kLeft_px + right), height - 8.0}, plot.x_name, Anchor::middle);
  svg.upright_label({14.0, 0.5 * (kTop_px + bottom)}, plot.y_name);
}

void draw_series(const XySeries& series, const Axes& axes, Svg& svg) {
  const std::size_t step = series.points.size() / kMostPoints + 1;
  std::vector<Point> run;
  const auto end_run = [&] {
    if (series.mark == XyMark::dashed) {
      for (std::size_t i = 1; i < run.size(); ++i) {
        if ((i / 6) % 2 == 0) svg.line(run[i - 1], run[i], series.colour, 1.5);
      }
    } else if (run.size() > 1) {
      svg.polyline(run, series.colour, 1.5);
    } else if (run.size() == 1) {
      svg.marker(Marker::circle, run.front(), 1.0, series.colour);
    }
    run.clear();
  };
  for (std::size_t i = 0; i < series.points.size(); ++i) {
    const Point& point = series.points[i];
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
      end_run();
      continue;
    }
    if (i % step != 0 && i + 1 != series.points.size()) continue;
    if (series.mark == XyMark::dots) {
      svg.marker(Marker::circle, axes.at(point), 1.6, series.colour);
    } else {
      run.push_back(axes.at(point));
    }
  }
  end_run();
}

void draw_legend(const XyPlot& plot, Svg& svg) {
  double left = kLeft_px;
  for (const XySeries& series : plot.series) {
    if (series.name.empty()) continue;
    const double y = 33.0;
    if (series.mark == XyMark::dots)
      svg.marker(Marker::circle, {left + 8.0, y}, 3.0, series.colour);
    else
      svg.line({left, y}, {left + 16.0, y}, series.colour, 2.0, series.mark == XyMark::dashed);
    svg.label({left + 21.0, y + 4.0}, series.name, Anchor::start, 11.0);
    left += 38.0 + kCharacter_px * static_cast<double>(series.name.size());
  }
}

}  // namespace

double nice_step(double range) {
  const double power = std::pow(10.0, std::floor(std::log10(range / 5.0)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= range / 5.0) return factor * power;
  }
  return 10.0 * power;
}

std::string draw(const XyPlot& plot, int width, int height) {
  Svg svg(width, height, plot.title);
  svg.label({kLeft_px, 16.0}, plot.title, Anchor::start, 13.0);
  const Axes axes = axes_of(plot, width, height);
  if (axes.x.span.is_empty()) {
    svg.label({0.5 * width, 0.5 * height}, "nothing to draw", Anchor::middle);
    return svg.str();
  }
  draw_patches(plot, axes, svg);
  draw_grid(plot, axes, width, height, svg);
  draw_legend(plot, svg);
  for (const XySeries& series : plot.series) draw_series(series, axes, svg);
  return svg.str();
}

}  // namespace lsv::cli
