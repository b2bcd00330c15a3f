// SPDX-License-Identifier: BSD-3-Clause
// Quantities over time, or a path on the plane: linear axes with round ticks around all that is to
// be drawn. Long lines are thinned to what a page shows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lsv/output/svg.h"

namespace lsv::cli {

enum class XyMark { line, dashed, dots };

struct XySeries {
  std::string name;  // empty: not in the legend
  std::string_view colour;
  std::vector<Point> points;  // a gap where either is NaN
  XyMark mark = XyMark::line;
};

/// A rectangle of the plane, drawn first.
struct XyPatch {
  double left = 0.0, right = 0.0, bottom = 0.0, top = 0.0;
  std::string_view colour;
  std::string name;
};

struct XyPlot {
  std::string title;
  std::string x_name;
  std::string y_name;
  std::vector<XySeries> series;
  std::vector<XyPatch> patches;  // do not widen the axes
  bool has_equal_axes = false;   // a map: one unit is as long both ways
  bool includes_zero_y = false;
};

/// `width` and `height` in px.
std::string draw(const XyPlot& plot, int width, int height);

/// 1, 2 or 5 times a power of ten, a fifth of `range` (> 0) or a little more.
double nice_step(double range);

}  // namespace lsv::cli
