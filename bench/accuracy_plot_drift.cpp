// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "bench/accuracy_limits.h"
#include "bench/accuracy_panel.h"
#include "bench/accuracy_plots.h"
#include "bench/accuracy_text.h"
#include "lsv/output/number_text.h"

namespace lsv::bench {
namespace {

constexpr int kWidth = 960;
constexpr double kTop = 44.0;
constexpr double kLeft = 70.0;
constexpr double kPanelHeight = 260.0;
constexpr double kLow_percent = 1e-5;
constexpr double kHigh_percent = 10.0;
constexpr double kBarRatio = 0.32;  // of the width of a drive

void draw_drive(Svg& svg, const Box& box, const ValueAxis& axis, double left, double width,
                const DriftResult& drive) {
  const double bar = kBarRatio * width;
  const double precise = axis.y(100.0 * std::abs(drive.precise_error_ratio));
  const double classic = axis.y(100.0 * std::abs(drive.classic_error_ratio));
  const double middle = left + 0.5 * width;
  svg.rect({middle - bar, precise}, bar - 1.0, box.bottom() - precise, colour_of("precise"));
  svg.rect({middle, classic}, bar - 1.0, box.bottom() - classic, colour_of("classic"));
  svg.label({middle, box.bottom() + 16.0}, formatted("%g", drive.speed_px_per_frame),
            Anchor::middle, 11.0);
  svg.label({middle, box.bottom() + 32.0}, formatted("%g px", drive.speckle_px), Anchor::middle,
            11.0);
}

}  // namespace

std::string plot_drift(const AccuracyResults& results) {
  Svg svg(kWidth, static_cast<int>(kTop + kPanelHeight + 66.0),
          "Error of the distance after a long drive");
  const Box box{kLeft, kTop, kWidth - kLeft - 10.0, kPanelHeight};
  const ValueAxis axis(box, Scale::logarithmic, kLow_percent, kHigh_percent);
  draw_legend(
      svg, {kLeft, 18.0},
      {{"precise", colour_of("precise")}, {"classic, peak fit gaussian3", colour_of("classic")}});
  svg.line({kLeft + 330.0, 14.0}, {kLeft + 360.0, 14.0}, kInk, 1.5, true);
  svg.label({kLeft + 366.0, 18.0}, "Must of precise");
  axis.draw(svg, {1e-5, 1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0}, "|error of the distance|, %");
  double left = box.left;
  const double width =
      box.width / static_cast<double>(std::max<std::size_t>(1, results.drifts.size()));
  for (const DriftResult& drive : results.drifts) {
    draw_drive(svg, box, axis, left, width, drive);
    left += width;
  }
  const double must = axis.y(100.0 * kMustDriftRatio);
  svg.line({box.left, must}, {box.right(), must}, kInk, 1.5, true);
  svg.label({box.left + 0.5 * box.width, box.bottom() + 52.0},
            "speed along x, px per frame; size of the speckle", Anchor::middle);
  return svg.str();
}

}  // namespace lsv::bench
