// SPDX-License-Identifier: BSD-3-Clause
// A frame to plot in: where values go along the y axis, with grid and numbers. What the x axis
// means is for the plot to say.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lsv/output/svg.h"

namespace lsv::bench {

/// The inside of the frame, px.
struct Box {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;
  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

enum class Scale { linear, logarithmic };

class ValueAxis {
 public:
  /// `low` < `high`; both > 0 when logarithmic.
  ValueAxis(const Box& box, Scale scale, double low, double high);

  /// Height on the drawing; held inside the box.
  double y(double value) const;
  /// Grid line and number for each value, the name of the axis beside them.
  void draw(Svg& svg, const std::vector<double>& ticks, std::string_view name) const;

 private:
  Box box_;
  Scale scale_;
  double low_;
  double high_;
};

/// 1, 2 or 5 times a power of ten, no less than `value` > 0.
double round_up(double value);

/// The same in every picture.
std::string_view colour_of(std::string_view method);

/// One entry per method or size, in a row that starts at `at`.
struct LegendEntry {
  std::string_view name;
  std::string_view colour;
  Marker marker = Marker::square;
};
void draw_legend(Svg& svg, Point at, const std::vector<LegendEntry>& entries);

}  // namespace lsv::bench
