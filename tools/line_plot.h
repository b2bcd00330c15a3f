// SPDX-License-Identifier: BSD-3-Clause
// One quantity against another as lines and marks in a frame.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lsv/output/svg.h"

namespace lsv::cli {

enum class AxisScale { linear, logarithmic };

struct LineSeries {
  std::string name;
  std::string_view colour;
  std::vector<Point> points;  // rising x; a gap where y is NaN
  bool is_marked = false;     // points as marks, not as a line
};

struct LinePlot {
  std::string title;
  std::string x_name;
  std::string y_name;
  AxisScale x_scale = AxisScale::linear;  // y is logarithmic
  std::vector<double> x_ticks;            // first and last are the ends of the axis
  std::vector<LineSeries> series;
  std::optional<Point> here;  // a place to point out; its x is held inside the frame
};

/// `width` and `height` in px.
std::string draw(const LinePlot& plot, int width, int height);

}  // namespace lsv::cli
