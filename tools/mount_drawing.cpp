// SPDX-License-Identifier: BSD-3-Clause
#include "tools/mount_drawing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lsv/output/number_text.h"
#include "lsv/output/svg.h"
#include "tools/xy_plot.h"

namespace lsv::cli {
namespace {

constexpr double kSide_px = 460.0;
constexpr double kMargin_px = 40.0;

/// Body axes to the page.
struct TopView {
  double middle_x_m = 0.0;
  double middle_y_m = 0.0;
  double px_per_m = 1.0;

  Point at(double x_m, double y_m) const {
    return {0.5 * kSide_px - px_per_m * (y_m - middle_y_m),
            0.5 * kSide_px - px_per_m * (x_m - middle_x_m)};
  }
};

TopView view_of(const MountReport& report) {
  double least_x = 0.0, most_x = 0.0, least_y = 0.0, most_y = 0.0;
  for (const MountedSensor& sensor : report.sensors) {
    least_x = std::min(least_x, sensor.fit.x_m);
    most_x = std::max(most_x, sensor.fit.x_m);
    least_y = std::min(least_y, sensor.fit.y_m);
    most_y = std::max(most_y, sensor.fit.y_m);
  }
  constexpr double kSmallest_m = 0.02;
  const double reach_m = std::max({most_x - least_x, most_y - least_y, kSmallest_m});
  // Room for the axes of a sensor at the border.
  return {.middle_x_m = 0.5 * (least_x + most_x),
          .middle_y_m = 0.5 * (least_y + most_y),
          .px_per_m = (kSide_px - 2.0 * kMargin_px) / (1.5 * reach_m)};
}

void draw_grid(const TopView& view, Svg& svg) {
  const double step_m = nice_step(kSide_px / view.px_per_m);
  const double half_m = 0.5 * kSide_px / view.px_per_m;
  const auto each_tick = [&](double middle_m, const auto& draw) {
    for (double i = std::ceil((middle_m - half_m) / step_m); i * step_m <= middle_m + half_m; ++i)
      draw(i * step_m);
  };
  each_tick(view.middle_x_m, [&](double x_m) {
    const double y_px = view.at(x_m, 0.0).y;
    svg.line({0.0, y_px}, {kSide_px, y_px}, kFaint);
    svg.label({4.0, y_px - 3.0}, formatted("%g m", x_m), Anchor::start, 10.0);
  });
  each_tick(view.middle_y_m, [&](double y_m) {
    const double x_px = view.at(0.0, y_m).x;
    svg.line({x_px, 0.0}, {x_px, kSide_px}, kFaint);
    svg.label({x_px + 3.0, kSide_px - 4.0}, formatted("%g m", y_m), Anchor::start, 10.0);
  });
}

void draw_arrow(Point from, Point to, std::string_view colour, double width, Svg& svg) {
  svg.line(from, to, colour, width);
  const double angle = std::atan2(to.y - from.y, to.x - from.x);
  constexpr double kHead_px = 9.0;
  for (const double side : {-0.45, 0.45})
    svg.line(to,
             {to.x - kHead_px * std::cos(angle + side), to.y - kHead_px * std::sin(angle + side)},
             colour, width);
}

/// Axes of a frame whose x axis points to `yaw_rad`.
void draw_axes(const TopView& view, double x_m, double y_m, double yaw_rad, double length_px,
               double width, Svg& svg) {
  const double length_m = length_px / view.px_per_m;
  const Point origin = view.at(x_m, y_m);
  const double c = length_m * std::cos(yaw_rad);
  const double s = length_m * std::sin(yaw_rad);
  const Point x_end = view.at(x_m + c, y_m + s);
  const Point y_end = view.at(x_m - s, y_m + c);
  draw_arrow(origin, x_end, kForwardColour, width, svg);
  draw_arrow(origin, y_end, kLeftColour, width, svg);
  const auto beyond = [origin](Point end) {
    return Point{origin.x + 1.25 * (end.x - origin.x), origin.y + 1.25 * (end.y - origin.y) + 4.0};
  };
  svg.label(beyond(x_end), "x", Anchor::middle, 12.0, kForwardColour);
  svg.label(beyond(y_end), "y", Anchor::middle, 12.0, kLeftColour);
}

constexpr double kEllipseSigmas = 2.0;

void draw_ellipse(const TopView& view, const MountFit& fit, double magnified, Svg& svg) {
  // Columns of the root of the covariance.
  const double a = std::sqrt(fit.cov[0][0]);
  const double b = fit.cov[0][1] / a;
  const double c = std::sqrt(std::max(0.0, fit.cov[1][1] - b * b));
  std::vector<Point> outline;
  constexpr int kCorners = 60;
  for (int i = 0; i <= kCorners; ++i) {
    const double t = 2.0 * std::numbers::pi * i / kCorners;
    const double r = kEllipseSigmas * magnified;
    outline.push_back(
        view.at(fit.x_m + r * a * std::cos(t), fit.y_m + r * (b * std::cos(t) + c * std::sin(t))));
  }
  svg.polyline(outline, kInk, 1.0);
}

/// The power of ten that makes the largest ellipse visible.
double magnification(const TopView& view, const MountReport& report) {
  constexpr double kVisible_px = 5.0;
  double largest_px = 0.0;
  for (const MountedSensor& sensor : report.sensors)
    largest_px =
        std::max(largest_px, view.px_per_m * kEllipseSigmas *
                                 std::sqrt(std::max(sensor.fit.cov[0][0], sensor.fit.cov[1][1])));
  return std::pow(10.0, std::max(0.0, std::ceil(std::log10(kVisible_px / largest_px))));
}

struct Frame {
  double left_px, top_px, width_px, height_px;
  double duration_s;
  double reach_mm;  // of the vertical axis, to either side

  Point at(double time_s, double value_mm) const {
    return {left_px + width_px * time_s / duration_s,
            top_px + 0.5 * height_px * (1.0 - std::clamp(value_mm / reach_mm, -1.0, 1.0))};
  }
};

struct Dot {
  double time_s;
  double value_mm;
};

std::vector<Dot> means(const std::vector<Dot>& dots, std::size_t bins) {
  std::vector<Dot> out;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const std::size_t begin = dots.size() * bin / bins;
    const std::size_t end = dots.size() * (bin + 1) / bins;
    Dot mean{0.0, 0.0};
    for (std::size_t i = begin; i < end; ++i) {
      mean.time_s += dots[i].time_s / static_cast<double>(end - begin);
      mean.value_mm += dots[i].value_mm / static_cast<double>(end - begin);
    }
    if (end > begin) out.push_back(mean);
  }
  return out;
}

void draw_series(const Frame& frame, const std::vector<Dot>& dots, std::string_view colour,
                 Svg& svg) {
  constexpr std::size_t kMostDots = 600;
  constexpr std::size_t kBins = 60;
  const std::string pale = std::string(colour) + "55";
  const std::size_t step = dots.size() / kMostDots + 1;
  for (std::size_t i = 0; i < dots.size(); i += step)
    svg.marker(Marker::circle, frame.at(dots[i].time_s, dots[i].value_mm), 1.4, pale);
  std::vector<Point> line;
  for (const Dot& mean : means(dots, std::min(kBins, dots.size() / 4 + 1)))
    line.push_back(frame.at(mean.time_s, mean.value_mm));
  svg.polyline(line, colour, 1.8);
}

void draw_time_axes(const Frame& frame, Svg& svg) {
  const double step_mm = nice_step(2.0 * frame.reach_mm);
  for (double i = std::ceil(-frame.reach_mm / step_mm); i * step_mm <= frame.reach_mm; ++i) {
    const Point at = frame.at(0.0, i * step_mm);
    svg.line(at, {frame.left_px + frame.width_px, at.y}, kFaint);
    svg.label({frame.left_px - 6.0, at.y + 4.0}, formatted("%g", i * step_mm), Anchor::end);
  }
  const double step_s = nice_step(0.5 * frame.duration_s);
  for (double i = 0.0; i * step_s <= frame.duration_s; ++i) {
    const double x_px = frame.at(i * step_s, 0.0).x;
    svg.line({x_px, frame.top_px}, {x_px, frame.top_px + frame.height_px}, kFaint);
    svg.label({x_px, frame.top_px + frame.height_px + 16.0}, formatted("%g", i * step_s),
              Anchor::middle);
  }
  svg.upright_label({14.0, frame.top_px + 0.5 * frame.height_px}, "reference less fit, mm");
  svg.label({frame.left_px + frame.width_px, frame.top_px + frame.height_px + 34.0},
            "time since the first pose used, s", Anchor::end);
}

}  // namespace

std::string vehicle_svg(const MountReport& report) {
  const TopView view = view_of(report);
  constexpr double kCaption_px = 24.0;
  Svg svg(static_cast<int>(kSide_px), static_cast<int>(kSide_px + kCaption_px),
          "the vehicle from above");
  draw_grid(view, svg);
  const double magnified = magnification(view, report);
  constexpr double kBodyAxis_px = 60.0;
  constexpr double kSensorAxis_px = 38.0;
  draw_axes(view, 0.0, 0.0, 0.0, kBodyAxis_px, 1.2, svg);
  const Point origin = view.at(0.0, 0.0);
  svg.label({origin.x + 8.0, origin.y + 16.0}, "body");
  for (const MountedSensor& sensor : report.sensors) {
    const Point at = view.at(sensor.fit.x_m, sensor.fit.y_m);
    draw_axes(view, sensor.fit.x_m, sensor.fit.y_m, sensor.fit.yaw_rad, kSensorAxis_px, 2.2, svg);
    draw_ellipse(view, sensor.fit, magnified, svg);
    svg.marker(Marker::circle, at, 2.5, kInk);
    svg.label({at.x + 8.0, at.y + 18.0}, sensor_label(sensor), Anchor::start, 13.0);
  }
  svg.label({4.0, kSide_px + 16.0}, magnified > 1.0
                                        ? formatted("ellipses: 2 sigma, x %g", magnified)
                                        : std::string("ellipses: 2 sigma"));
  return svg.str();
}

std::string residuals_svg(const MountFit& fit) {
  constexpr double kMm = 1e3;
  constexpr double kBandSigmas = 2.0;
  std::vector<Dot> forward;
  std::vector<Dot> left;
  double sigma_mm = 0.0;
  double squares_mm2 = 0.0;
  const auto count = static_cast<double>(fit.residuals.size());
  for (const MountResidual& r : fit.residuals) {
    const double time_s = seconds_between(fit.residuals.front().stamp, r.stamp);
    forward.push_back({time_s, kMm * r.forward_m});
    left.push_back({time_s, kMm * r.left_m});
    sigma_mm += kMm * r.sigma_m / count;
    squares_mm2 += kMm * kMm * (r.forward_m * r.forward_m + r.left_m * r.left_m) / (2.0 * count);
  }
  constexpr double kReach = 4.0;
  const Frame frame{.left_px = 60.0,
                    .top_px = 10.0,
                    .width_px = 800.0,
                    .height_px = 220.0,
                    .duration_s = std::max(forward.back().time_s, 1e-9),
                    .reach_mm = kReach * std::max(sigma_mm, std::sqrt(squares_mm2))};
  Svg svg(880, 290, "residuals over time");
  const double band_top = frame.at(0.0, kBandSigmas * sigma_mm).y;
  const double band_bottom = frame.at(0.0, -kBandSigmas * sigma_mm).y;
  svg.rect({frame.left_px, band_top}, frame.width_px, band_bottom - band_top, kInk, 0.12);
  draw_time_axes(frame, svg);
  draw_series(frame, forward, kForwardColour, svg);
  draw_series(frame, left, kLeftColour, svg);
  const double legend_y = frame.top_px + frame.height_px + 34.0;
  svg.line({frame.left_px, legend_y - 4.0}, {frame.left_px + 20.0, legend_y - 4.0}, kForwardColour,
           2.0);
  svg.label({frame.left_px + 26.0, legend_y}, "forward");
  svg.line({frame.left_px + 90.0, legend_y - 4.0}, {frame.left_px + 110.0, legend_y - 4.0},
           kLeftColour, 2.0);
  svg.label({frame.left_px + 116.0, legend_y},
            "left; dots: poses, lines: means, band: 2 sigma of "
            "the reference");
  return svg.str();
}

}  // namespace lsv::cli
