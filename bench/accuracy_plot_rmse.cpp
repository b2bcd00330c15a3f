// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_panel.h"
#include "bench/accuracy_plots.h"
#include "bench/accuracy_text.h"
#include "lsv/output/number_text.h"

namespace lsv::bench {
namespace {

constexpr int kWidth = 960;
constexpr double kPanelHeight = 230.0;
constexpr double kPanelStep = 300.0;
constexpr double kTop = 64.0;
constexpr double kLeft = 70.0;
constexpr double kGroupFill = 0.84;  // of the width of a condition
constexpr double kLow_mpx = 0.05;
constexpr double kHigh_mpx = 1000.0;
constexpr double kFew = 0.01;  // outliers, of the pairs: not marked

void draw_bar(Svg& svg, const Box& box, const ValueAxis& axis, double left, double width,
              const MethodErrors& entry) {
  const std::string_view colour = colour_of(entry.method);
  const Errors& errors = entry.errors;
  double top = box.bottom();
  if (!errors.fails()) {
    top = axis.y(errors.rmse_px() * 1e3);
    svg.rect({left, top}, width - 1.0, box.bottom() - top, colour);
  }
  if (errors.outlier_ratio() > kFew)
    svg.label({left + 0.5 * (width - 1.0), top - 3.0}, "x", Anchor::middle, 12.0, colour);
}

void draw_case(Svg& svg, const Box& box, const ValueAxis& axis, double left, double width,
               const CaseResult& result) {
  const double bar = width * kGroupFill / static_cast<double>(result.methods.size());
  double x = left + 0.5 * (1.0 - kGroupFill) * width;
  for (const MethodErrors& entry : result.methods) {
    draw_bar(svg, box, axis, x, bar, entry);
    x += bar;
  }
  const double bound = axis.y(result.bound_px * 1e3);
  svg.line({left + 2.0, bound}, {left + width - 2.0, bound}, kInk, 1.5, true);
  svg.label({left + 0.5 * width, box.bottom() + 16.0}, result.condition->name, Anchor::middle);
}

void draw_panel(Svg& svg, const AccuracyResults& results, int size) {
  const Box box{kLeft, kTop + size * kPanelStep, kWidth - kLeft - 10.0, kPanelHeight};
  const ValueAxis axis(box, Scale::logarithmic, kLow_mpx, kHigh_mpx);
  svg.label({box.left, box.top - 8.0}, formatted("speckle of %g px", kSpeckleSizes_px[size]));
  axis.draw(svg, {0.1, 1.0, 10.0, 100.0, 1000.0}, "RMSE per axis, mpx");
  const double width = box.width / static_cast<double>(conditions().size());
  double left = box.left;
  for (const Condition& condition : conditions()) {
    const CaseResult* result = results.find(condition.name, size);
    if (result != nullptr) draw_case(svg, box, axis, left, width, *result);
    left += width;
  }
  svg.label({box.left + 0.5 * box.width, box.bottom() + 34.0}, "condition", Anchor::middle);
}

}  // namespace

std::string plot_rmse(const AccuracyResults& results) {
  Svg svg(kWidth, static_cast<int>(kTop + kSpeckleSizes * kPanelStep - 10.0),
          "Root of the mean square error per condition and method");
  std::vector<LegendEntry> legend;
  if (!results.cases.empty())
    for (const MethodErrors& entry : results.cases.front().methods)
      legend.push_back({entry.method, colour_of(entry.method)});
  draw_legend(svg, {kLeft, 18.0}, legend);
  svg.line({660.0, 14.0}, {690.0, 14.0}, kInk, 1.5, true);
  svg.label({696.0, 18.0}, "Cramer-Rao bound");
  svg.label({830.0, 18.0}, "x  outliers > 1 %");
  for (int size = 0; size < kSpeckleSizes; ++size) draw_panel(svg, results, size);
  return svg.str();
}

}  // namespace lsv::bench
