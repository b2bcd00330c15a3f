// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "bench/accuracy_panel.h"
#include "bench/accuracy_plots.h"
#include "bench/accuracy_text.h"
#include "lsv/output/number_text.h"

namespace lsv::bench {
namespace {

constexpr int kWidth = 960;
constexpr double kTop = 34.0;
constexpr double kLeft = 70.0;
constexpr double kPanelWidth = 385.0;
constexpr double kPanelHeight = 110.0;
constexpr double kColumnStep = 485.0;
constexpr double kRowStep = 165.0;

double largest_mpx(const SCurve& curve) {
  double out = 0.0;
  for (std::size_t k = 0; k < curve.bias_px.size(); ++k)
    out = std::max(out, 1e3 * (std::abs(curve.bias_px[k]) + curve.standard_error_px[k]));
  return out;
}

void draw_curve(Svg& svg, const Box& box, const SCurve& curve, double range_mpx) {
  const ValueAxis axis(box, Scale::linear, -range_mpx, range_mpx);
  const std::string_view colour = colour_of(curve.method);
  svg.label({box.left, box.top - 8.0},
            formatted("%s, speckle of %g px", std::string(curve.method).c_str(),
                      kSpeckleSizes_px[curve.size]));
  axis.draw(svg, {-range_mpx, -0.5 * range_mpx, 0.0, 0.5 * range_mpx, range_mpx}, "bias, mpx");
  svg.line({box.left, axis.y(0.0)}, {box.right(), axis.y(0.0)}, kInk);
  for (const double shift_px : {0.0, 0.25, 0.5, 0.75, 1.0})
    svg.label({box.left + shift_px * box.width, box.bottom() + 15.0}, formatted("%g", shift_px),
              Anchor::middle, 11.0);
  svg.label({box.left + 0.5 * box.width, box.bottom() + 30.0}, "shift along x, px", Anchor::middle,
            11.0);
  std::vector<Point> points;
  for (std::size_t k = 0; k < curve.shift_px.size(); ++k) {
    const double x = box.left + curve.shift_px[k] * box.width;
    const double bias_mpx = 1e3 * curve.bias_px[k];
    const double error_mpx = 1e3 * curve.standard_error_px[k];
    svg.line({x, axis.y(bias_mpx - error_mpx)}, {x, axis.y(bias_mpx + error_mpx)}, colour);
    points.push_back({x, axis.y(bias_mpx)});
  }
  svg.polyline(points, colour);
  for (const Point& p : points) svg.marker(Marker::circle, p, 2.5, colour);
}

}  // namespace

std::string plot_s_curves(const AccuracyResults& results) {
  std::vector<std::string_view> methods;
  for (const SCurve& curve : results.s_curves)
    if (std::find(methods.begin(), methods.end(), curve.method) == methods.end())
      methods.push_back(curve.method);
  const double height = kTop + kRowStep * static_cast<double>(methods.size());
  Svg svg(kWidth, static_cast<int>(height), "Bias against the fraction of a pixel moved");
  for (std::size_t row = 0; row < methods.size(); ++row) {
    double range_mpx = 1e-3;
    for (const SCurve& curve : results.s_curves)
      if (curve.method == methods[row]) range_mpx = std::max(range_mpx, largest_mpx(curve));
    range_mpx = round_up(range_mpx);
    double left = kLeft;
    for (const SCurve& curve : results.s_curves) {
      if (curve.method != methods[row]) continue;
      const double top = kTop + kRowStep * static_cast<double>(row);
      draw_curve(svg, {left, top, kPanelWidth, kPanelHeight}, curve, range_mpx);
      left += kColumnStep;
    }
  }
  return svg.str();
}

}  // namespace lsv::bench
