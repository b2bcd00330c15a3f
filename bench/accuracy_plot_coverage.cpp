// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_limits.h"
#include "bench/accuracy_panel.h"
#include "bench/accuracy_plots.h"
#include "bench/accuracy_text.h"

namespace lsv::bench {
namespace {

constexpr int kWidth = 960;
constexpr double kTop = 64.0;
constexpr double kLeft = 70.0;
constexpr double kPanelHeight = 190.0;
constexpr double kPanelStep = 262.0;
constexpr double kRadius = 4.0;
constexpr double kSizeStep = 15.0;
constexpr Marker kMarkers[kSpeckleSizes] = {Marker::circle, Marker::square, Marker::triangle};
constexpr std::string_view kPresets[] = {"precise", "fast", "classic"};

void draw_band(Svg& svg, const Box& box, const ValueAxis& axis, double nominal, double margin) {
  const double top = axis.y(100.0 * (nominal + margin));
  const double bottom = axis.y(100.0 * (nominal - margin));
  svg.rect({box.left, top}, box.width, bottom - top, kInk, 0.22);
}

void draw_panel(Svg& svg, const AccuracyResults& results, int row) {
  const std::string_view preset = kPresets[row];
  const Box box{kLeft, kTop + row * kPanelStep, kWidth - kLeft - 10.0, kPanelHeight};
  const ValueAxis axis(box, Scale::linear, 0.0, 100.0);
  svg.label({box.left, box.top - 8.0}, preset);
  draw_band(svg, box, axis, kMustWithin1, kMustWithin1Margin);
  draw_band(svg, box, axis, kMustWithin196, kMustWithin196Margin);
  axis.draw(svg, {0.0, 25.0, 50.0, 75.0, 100.0}, "errors within, %");
  const double width = box.width / static_cast<double>(conditions().size());
  double middle = box.left + 0.5 * width;
  for (const Condition& condition : conditions()) {
    for (int size = 0; size < kSpeckleSizes; ++size) {
      const CaseResult* result = results.find(condition.name, size);
      const Errors* errors = result != nullptr ? result->errors_of(preset) : nullptr;
      if (errors == nullptr || !errors->has_sigma()) continue;
      const double x = middle + (size - 1) * kSizeStep;
      svg.marker(kMarkers[size], {x, axis.y(100.0 * errors->within_1_sigma())}, kRadius, "#2f80ed");
      svg.marker(kMarkers[size], {x, axis.y(100.0 * errors->within_196_sigma())}, kRadius,
                 "#d9542b");
    }
    svg.label({middle, box.bottom() + 16.0}, condition.name, Anchor::middle);
    middle += width;
  }
  svg.label({box.left + 0.5 * box.width, box.bottom() + 34.0}, "condition", Anchor::middle);
}

}  // namespace

std::string plot_coverage(const AccuracyResults& results) {
  Svg svg(kWidth, static_cast<int>(kTop + 3.0 * kPanelStep - 10.0),
          "Share of the errors within the sigmas stated");
  draw_legend(svg, {kLeft, 18.0},
              {{"within 1 sigma", "#2f80ed"}, {"within 1.96 sigma", "#d9542b"}});
  draw_legend(svg, {kLeft + 330.0, 18.0},
              {{"speckle of 3 px", kInk, kMarkers[0]},
               {"4 px", kInk, kMarkers[1]},
               {"6 px", kInk, kMarkers[2]}});
  svg.rect({kLeft + 610.0, 8.0}, 22.0, 12.0, kInk, 0.22);
  svg.label({kLeft + 640.0, 18.0}, "Must of precise");
  for (int row = 0; row < 3; ++row) draw_panel(svg, results, row);
  return svg.str();
}

}  // namespace lsv::bench
