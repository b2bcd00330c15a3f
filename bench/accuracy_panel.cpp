// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_panel.h"

#include <algorithm>
#include <cmath>

#include "bench/accuracy_text.h"
#include "lsv/output/number_text.h"

namespace lsv::bench {
namespace {

constexpr double kNameGap_px = 50.0;   // between the axis and its name
constexpr double kCharacter_px = 7.0;  // of a legend, about

}  // namespace

ValueAxis::ValueAxis(const Box& box, Scale scale, double low, double high)
    : box_(box), scale_(scale), low_(low), high_(high) {}

double ValueAxis::y(double value) const {
  const double held = std::clamp(value, low_, high_);
  const double ratio = scale_ == Scale::logarithmic ? std::log(held / low_) / std::log(high_ / low_)
                                                    : (held - low_) / (high_ - low_);
  return box_.bottom() - ratio * box_.height;
}

void ValueAxis::draw(Svg& svg, const std::vector<double>& ticks, std::string_view name) const {
  for (const double tick : ticks) {
    svg.line({box_.left, y(tick)}, {box_.right(), y(tick)}, kFaint);
    svg.label({box_.left - 6.0, y(tick) + 4.0}, formatted("%g", tick), Anchor::end, 11.0);
  }
  svg.line({box_.left, box_.top}, {box_.left, box_.bottom()}, kInk);
  svg.line({box_.left, box_.bottom()}, {box_.right(), box_.bottom()}, kInk);
  svg.upright_label({box_.left - kNameGap_px, box_.top + 0.5 * box_.height}, name);
}

std::string_view colour_of(std::string_view method) {
  struct Entry {
    std::string_view method;
    std::string_view colour;
  };
  static constexpr Entry kColours[] = {{"precise", "#2f80ed"},       {"fast", "#2bb3a3"},
                                       {"classic", "#8a7ff0"},       {"phaseCorrelate", "#d9542b"},
                                       {"matchTemplate", "#e0a020"}, {"ECC", "#c2679f"}};
  for (const Entry& entry : kColours)
    if (entry.method == method) return entry.colour;
  return kInk;
}

double round_up(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= value) return step * decade;
  return 10.0 * decade;
}

void draw_legend(Svg& svg, Point at, const std::vector<LegendEntry>& entries) {
  for (const LegendEntry& entry : entries) {
    svg.marker(entry.marker, {at.x + 5.0, at.y - 4.0}, 5.0, entry.colour);
    svg.label({at.x + 15.0, at.y}, entry.name);
    at.x += 32.0 + kCharacter_px * static_cast<double>(entry.name.size());
  }
}

}  // namespace lsv::bench
