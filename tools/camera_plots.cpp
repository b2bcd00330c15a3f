// SPDX-License-Identifier: BSD-3-Clause
#include "tools/camera_plots.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/output/base64.h"
#include "lsv/output/frame_writer.h"
#include "lsv/output/number_text.h"
#include "lsv/output/svg.h"

namespace lsv::cli {
namespace {

constexpr std::string_view kBlue = "#2f80ed";
constexpr std::string_view kRed = "#d9542b";

struct Range {
  double low = 0.0;
  double high = 1.0;
};

/// 1, 2 or 5 times a power of ten, so that about `count` steps make up the range.
double tick_step(const Range& range, int count) {
  const double rough = (range.high - range.low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

/// Axes in a drawing, and where a point lies between them.
class Axes {
 public:
  Axes(Point corner, double width, double height, Range x, Range y)
      : corner_(corner), width_(width), height_(height), x_(x), y_(y) {}

  double x_at(double x) const { return corner_.x + width_ * (x - x_.low) / (x_.high - x_.low); }
  double y_at(double y) const {
    return corner_.y + height_ * (1.0 - (y - y_.low) / (y_.high - y_.low));
  }
  Point at(double x, double y) const { return {x_at(x), y_at(y)}; }
  bool has_y(double y) const { return y >= y_.low && y <= y_.high; }
  Point corner() const { return corner_; }
  double bottom() const { return corner_.y + height_; }
  double right() const { return corner_.x + width_; }

  void draw_x(Svg& svg, const char* name) const {
    const double step = tick_step(x_, 6);
    for (double x = std::ceil(x_.low / step) * step; x <= x_.high + 1e-9 * step; x += step) {
      svg.line({x_at(x), corner_.y}, {x_at(x), bottom()}, kFaint);
      svg.label({x_at(x), bottom() + 16.0}, tick_text(x, step), Anchor::middle);
    }
    svg.label({0.5 * (corner_.x + right()), bottom() + 34.0}, name, Anchor::middle);
  }
  void draw_y(Svg& svg, const char* name, int ticks) const {
    const double step = tick_step(y_, ticks);
    for (double y = std::ceil(y_.low / step) * step; y <= y_.high + 1e-9 * step; y += step) {
      svg.line({corner_.x, y_at(y)}, {right(), y_at(y)}, kFaint);
      svg.label({corner_.x - 6.0, y_at(y) + 4.0}, tick_text(y, step), Anchor::end);
    }
    svg.upright_label({14.0, 0.5 * (corner_.y + bottom())}, name);
  }

 private:
  static std::string tick_text(double value, double step) {
    const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
    std::string out;
    append_fixed(out, value, std::min(decimals, 9));
    return out;
  }

  Point corner_;
  double width_;
  double height_;
  Range x_;
  Range y_;
};

std::string figure(const std::string& drawing, const std::string& caption) {
  return "<figure>" + drawing + "<figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

constexpr int kWidth = 640;
constexpr double kLeft = 78.0;
constexpr double kTop = 14.0;
constexpr double kPlotWidth = kWidth - kLeft - 16.0;

/// Above that of the dark.
Measured noise_counts2(const LightLevel& level, const LightLevel& dark) {
  return level.point.variance_counts2 - dark.point.variance_counts2;
}

struct LevelMark {
  Marker shape;
  std::string_view colour;
};
LevelMark mark_of(const LightLevel& level) {
  if (level.used) return {Marker::circle, kBlue};
  return level.saturated ? LevelMark{Marker::triangle, kRed} : LevelMark{Marker::square, kInk};
}

/// What the marks mean, along one line.
void draw_key(Svg& svg, Point at, bool with_saturated) {
  svg.marker(Marker::circle, at, 4.0, kBlue);
  svg.label({at.x + 9.0, at.y + 4.0}, "used for K");
  svg.marker(Marker::square, {at.x + 100.0, at.y}, 4.0, kInk);
  svg.label({at.x + 109.0, at.y + 4.0}, "beyond 70 % of saturation");
  if (!with_saturated) return;
  svg.marker(Marker::triangle, {at.x + 275.0, at.y}, 4.0, kRed);
  svg.label({at.x + 284.0, at.y + 4.0}, "saturated");
}

/// Points with bars of 2 sigma about 0, the rest of the drawing below the axes.
void draw_departures(Svg& svg, const Axes& axes, double x, const Measured& departure,
                     const LevelMark& mark) {
  const double low = departure.value - 2.0 * departure.sigma;
  const double high = departure.value + 2.0 * departure.sigma;
  svg.line(axes.at(x, low), axes.at(x, high), mark.colour, 1.5);
  svg.marker(mark.shape, axes.at(x, departure.value), 4.0, mark.colour);
}

/// Symmetric about 0 and a little wider than all of `departures`.
Range departure_range(const std::vector<Measured>& departures) {
  double most = 0.0;
  for (const Measured& d : departures) most = std::max(most, std::abs(d.value) + 2.0 * d.sigma);
  most = most > 0.0 ? 1.15 * most : 1.0;
  return {-most, most};
}

}  // namespace

std::string photon_transfer_plot(const CameraCharacterisation& camera) {
  constexpr double kHeight = 300.0, kGap = 56.0, kBelow = 110.0;
  const double dark = camera.mu_dark_counts.value;
  const double k = camera.transfer.k_counts_per_e.value;
  const auto signal = [dark](const LightLevel& l) { return l.point.mean_counts.value - dark; };
  double most_signal = camera.saturation_counts.value - dark;
  double most_noise = 0.0;
  std::vector<Measured> departures;
  for (const LightLevel& level : camera.flats) {
    const Measured noise = noise_counts2(level, camera.dark);
    most_signal = std::max(most_signal, signal(level));
    most_noise = std::max(most_noise, noise.value);
    if (level.saturated) continue;
    const double line = k * signal(level);
    departures.push_back({100.0 * (noise.value / line - 1.0), 100.0 * noise.sigma / line});
  }
  const Range x{0.0, 1.05 * most_signal};
  const Axes axes({kLeft, kTop}, kPlotWidth, kHeight, x, {0.0, 1.1 * most_noise});
  const Axes below({kLeft, kTop + kHeight + kGap}, kPlotWidth, kBelow, x,
                   departure_range(departures));
  Svg svg(kWidth, static_cast<int>(kTop + kHeight + kGap + kBelow) + 66, "photon transfer");

  axes.draw_x(svg, "signal, counts above the dark level");
  axes.draw_y(svg, "temporal noise above the dark, counts\u00b2", 6);
  if (camera.saturation_reached) {
    const double at = axes.x_at(camera.saturation_counts.value - dark);
    svg.line({at, kTop}, {at, axes.bottom()}, kRed, 1.0, true);
    svg.label({at - 5.0, axes.bottom() - 8.0}, "saturation", Anchor::end, 12.0, kRed);
  }
  const double range = camera.saturation_reached
                           ? camera.saturation_counts.value - dark
                           : full_scale_counts(camera.format.bit_depth) - dark;
  const double fitted = std::min(kLinearPart * range, x.high);
  const double end = std::min(x.high, 1.1 * most_noise / k);
  svg.line(axes.at(0.0, 0.0), axes.at(std::min(fitted, end), k * std::min(fitted, end)), kInk, 1.5);
  if (fitted < end) svg.line(axes.at(fitted, k * fitted), axes.at(end, k * end), kInk, 1.5, true);
  svg.marker(Marker::circle, axes.at(0.0, 0.0), 4.0, kBlue);

  below.draw_x(svg, "signal, counts above the dark level");
  below.draw_y(svg, "from the line, %", 4);
  svg.line(below.at(x.low, 0.0), below.at(x.high, 0.0), kInk, 1.5);
  std::size_t next = 0;
  for (const LightLevel& level : camera.flats) {
    const LevelMark mark = mark_of(level);
    const double noise = std::max(0.0, noise_counts2(level, camera.dark).value);
    svg.marker(mark.shape, axes.at(signal(level), noise), 4.5, mark.colour);
    if (!level.saturated) draw_departures(svg, below, signal(level), departures[next++], mark);
  }
  draw_key(svg, {kLeft + 6.0, below.bottom() + 54.0},
           std::ranges::any_of(camera.flats, [](const LightLevel& l) { return l.saturated; }));
  return figure(svg.str(),
                "Photon transfer: the slope of the line is K. Below: departures with 2 sigma.");
}

std::string linearity_plot(const CameraCharacterisation& camera) {
  const Linearity& line = camera.linearity;
  if (!std::isfinite(line.error_ratio.value)) return {};
  constexpr double kHeight = 220.0, kGap = 56.0, kBelow = 110.0;
  const auto signal = [&camera](const LightLevel& l) {
    return l.point.mean_counts.value - camera.mu_dark_counts.value;
  };
  double most_exposure = 0.0;
  double most_signal = 0.0;
  std::vector<Measured> departures;
  for (const LightLevel& level : camera.flats) {
    most_exposure = std::max(most_exposure, level.exposure_us);
    most_signal = std::max(most_signal, signal(level));
    if (level.saturated) continue;
    const double expected = line.offset_counts + line.slope_counts_per_us * level.exposure_us;
    departures.push_back({100.0 * (signal(level) / expected - 1.0),
                          100.0 * level.point.mean_counts.sigma / expected});
  }
  const Range x{0.0, 1.05 * most_exposure};
  const Axes axes({kLeft, kTop}, kPlotWidth, kHeight, x, {0.0, 1.1 * most_signal});
  const Axes below({kLeft, kTop + kHeight + kGap}, kPlotWidth, kBelow, x,
                   departure_range(departures));
  Svg svg(kWidth, static_cast<int>(kTop + kHeight + kGap + kBelow) + 44, "linearity");
  axes.draw_x(svg, "exposure, us");
  axes.draw_y(svg, "signal, counts", 5);
  const double end =
      std::min(x.high, (1.1 * most_signal - line.offset_counts) / line.slope_counts_per_us);
  svg.line(axes.at(0.0, std::max(0.0, line.offset_counts)),
           axes.at(end, line.offset_counts + line.slope_counts_per_us * end), kInk, 1.5);
  below.draw_x(svg, "exposure, us");
  below.draw_y(svg, "from the line, %", 4);
  svg.line(below.at(x.low, 0.0), below.at(x.high, 0.0), kInk, 1.5);
  std::size_t next = 0;
  for (const LightLevel& level : camera.flats) {
    const LevelMark mark =
        level.saturated ? LevelMark{Marker::triangle, kRed} : LevelMark{Marker::circle, kBlue};
    svg.marker(mark.shape, axes.at(level.exposure_us, signal(level)), 4.5, mark.colour);
    if (!level.saturated) draw_departures(svg, below, level.exposure_us, departures[next++], mark);
  }
  return figure(svg.str(), "Linearity: signal over exposure, and the departures with 2 sigma.");
}

namespace {

struct Spread {
  double mean = 0.0;
  double sd = 0.0;
};

Spread spread_of(std::span<const float> map, const std::vector<std::uint8_t>& defect) {
  double n = 0.0;
  double sum = 0.0;
  double sum2 = 0.0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (defect[i] != 0) continue;
    const auto value = static_cast<double>(map[i]);
    n += 1.0;
    sum += value;
    sum2 += value * value;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, sum2 / n - mean * mean))};
}

/// Bars over the good pixels; `limit` to both sides of the mean.
std::string histogram(std::span<const float> map, const SensorMaps& maps, double limit,
                      const char* name, const std::string& caption) {
  constexpr double kHeight = 220.0;
  constexpr int kBars = 81;
  const Spread spread = spread_of(map, maps.defect);
  double reach = std::max(4.0 * spread.sd, 1.1 * limit);
  if (!(reach > 0.0)) reach = 1.0;
  const Range x{spread.mean - reach, spread.mean + reach};
  const double step = 2.0 * reach / kBars;
  std::vector<int> counts(kBars);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (maps.defect[i] != 0) continue;
    const double bar = (static_cast<double>(map[i]) - x.low) / step;
    ++counts[static_cast<std::size_t>(std::clamp(bar, 0.0, kBars - 1.0))];
  }
  const int most = *std::ranges::max_element(counts);
  const Range y{0.0, std::log10(2.0 * most) + 0.3};
  const auto height_of = [](double count) { return std::log10(2.0 * count); };
  const Axes axes({kLeft, kTop}, kPlotWidth, kHeight, x, y);
  Svg svg(kWidth, static_cast<int>(kTop + kHeight) + 44, caption);
  axes.draw_x(svg, name);
  for (double decade = 1.0; height_of(decade) < y.high; decade *= 10.0) {
    svg.line({kLeft, axes.y_at(height_of(decade))}, {axes.right(), axes.y_at(height_of(decade))},
             kFaint);
    svg.label({kLeft - 6.0, axes.y_at(height_of(decade)) + 4.0}, formatted("%.0f", decade),
              Anchor::end);
  }
  svg.upright_label({14.0, kTop + 0.5 * kHeight}, "pixels");
  const double bar_width = kPlotWidth / kBars;
  for (int i = 0; i < kBars; ++i) {
    const int count = counts[static_cast<std::size_t>(i)];
    if (count == 0) continue;
    const double top = axes.y_at(height_of(count));
    svg.rect({kLeft + bar_width * i, top}, bar_width - 1.0, axes.bottom() - top, kBlue);
  }
  std::vector<Point> curve;
  const double peak =
      step * static_cast<double>(map.size()) / (spread.sd * std::sqrt(2.0 * std::numbers::pi));
  for (int i = 0; spread.sd > 0.0 && i <= 4 * kBars; ++i) {
    const double at = x.low + 0.25 * step * i;
    const double sigmas = (at - spread.mean) / spread.sd;
    const double value = height_of(peak * std::exp(-0.5 * sigmas * sigmas));
    if (axes.has_y(value)) curve.push_back(axes.at(at, value));
  }
  svg.polyline(curve, kInk);
  for (const double side : {-1.0, 1.0}) {
    const double at = axes.x_at(spread.mean + side * limit);
    svg.line({at, kTop}, {at, axes.bottom()}, kRed, 1.0, true);
  }
  return figure(svg.str(), caption);
}

/// One grey picture; pixels larger on the screen than one dot stay squares.
std::string picture(const SensorMaps& maps, const std::vector<std::uint8_t>& grey,
                    const std::string& caption) {
  Frame frame({.width_px = maps.width_px, .height_px = maps.height_px});
  const auto width = static_cast<std::size_t>(maps.width_px);
  for (int y = 0; y < maps.height_px; ++y)
    std::copy_n(grey.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * width),
                width, frame.row8(y));
  const Result<std::string> png = encode_png(frame.view());
  if (!png) return {};
  const std::span<const std::uint8_t> bytes(
      reinterpret_cast<const std::uint8_t*>(png.value().data()), png.value().size());
  return "<figure class=\"map\"><img alt=\"" + escaped(caption) +
         "\" src=\"data:image/png;base64," + base64(bytes) + "\"><figcaption>" + escaped(caption) +
         "</figcaption></figure>\n";
}

std::vector<std::uint8_t> greys_of(std::span<const float> map, const Spread& spread, double reach) {
  std::vector<std::uint8_t> out;
  out.reserve(map.size());
  for (const float value : map) {
    const double share = 0.5 + 0.5 * (static_cast<double>(value) - spread.mean) / reach;
    out.push_back(static_cast<std::uint8_t>(255.0 * std::clamp(share, 0.0, 1.0)));
  }
  return out;
}

/// White on black, and large enough to be seen in a picture of some hundred dots.
std::vector<std::uint8_t> marks_of(const SensorMaps& maps) {
  constexpr int kDots = 200;
  const int reach = std::max(maps.width_px, maps.height_px) / kDots;
  std::vector<std::uint8_t> out(maps.defect.size(), 24);
  const auto at = [&maps](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(maps.width_px) +
           static_cast<std::size_t>(x);
  };
  for (int y = 0; y < maps.height_px; ++y) {
    for (int x = 0; x < maps.width_px; ++x) {
      if (maps.defect[at(x, y)] == 0) continue;
      for (int v = std::max(0, y - reach); v <= std::min(maps.height_px - 1, y + reach); ++v) {
        for (int u = std::max(0, x - reach); u <= std::min(maps.width_px - 1, x + reach); ++u)
          out[at(u, v)] = 255;
      }
    }
  }
  return out;
}

}  // namespace

std::string offset_histogram(const CameraCharacterisation& camera) {
  return histogram(camera.maps.offset_counts, camera.maps, camera.defects.limits.offset_counts,
                   "dark level, counts",
                   "Dark levels of the good pixels. Curve: a Gaussian of the same spread; dashed: "
                   "the limit of a defect.");
}

std::string gain_histogram(const CameraCharacterisation& camera) {
  return histogram(camera.maps.gain_ratio, camera.maps, camera.defects.limits.response_ratio,
                   "gain, ratio",
                   "Gains of the good pixels. Curve: a Gaussian of the same spread; dashed: the "
                   "limit of a defect.");
}

std::string map_pictures(const CameraCharacterisation& camera) {
  const SensorMaps& maps = camera.maps;
  constexpr double kReach_sigmas = 3.0;
  const Spread offset = spread_of(maps.offset_counts, maps.defect);
  const Spread gain = spread_of(maps.gain_ratio, maps.defect);
  const double offset_reach = std::max(kReach_sigmas * offset.sd, 1e-6);
  const double gain_reach = std::max(kReach_sigmas * gain.sd, 1e-9);
  std::string out = "<div class=\"maps\">\n";
  out += picture(maps, greys_of(maps.offset_counts, offset, offset_reach),
                 formatted("Offset: black %.2f, white %.2f counts", offset.mean - offset_reach,
                           offset.mean + offset_reach));
  out += picture(
      maps, greys_of(maps.gain_ratio, gain, gain_reach),
      formatted("Gain: black %.4f, white %.4f", gain.mean - gain_reach, gain.mean + gain_reach));
  out += picture(maps, marks_of(maps),
                 formatted("Defects: %zu hot, %zu dead", camera.defects.counts.hot,
                           camera.defects.counts.dead));
  return out + "</div>\n";
}

}  // namespace lsv::cli
