// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/noise_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "calibration/noise_table.h"
#include "lsv/core/config.h"
#include "lsv/core/frame.h"

namespace lsv {
namespace {

using noise_table::AlongAcross;
using noise_table::ClippedFit;
using noise_table::PatternNode;
using noise_table::SaturationNode;

constexpr double kRoundingVariance_counts2 = 1.0 / 12.0;

// The fit (correlation/icgn.cpp): a border that gradients and interpolation need, widened in steps
// with the shift; the share of boiling from which clipped pixels are used like the others.
constexpr int kBorder_px = 4;
constexpr int kBorderStep_px = 6;
constexpr double kBoilingNotClipping = 4e-4;

// Where predictions were held against simulated frames.
constexpr int kSmallestSide_px = 48;
constexpr int kLargestSide_px = 512;
constexpr double kLargestShift = 0.5;  // of the side
constexpr double kSmallestRho = 0.5;
constexpr double kFewestUsed_px = 600.0;
constexpr double kZnccMargin = 1.5;  // over the gate: nearer, some shifts are refused

double square(double value) { return value * value; }

// ---- interpolation in the table ----------------------------------------------------------------

/// Between nodes `below` and below + 1.
struct Between {
  std::size_t below = 0;
  double weight = 0.0;  // of the upper one
};

/// `nodes` and `at` through `scale`, which makes figures nearly linear between nodes.
template <typename Scale>
Between between(std::span<const double> nodes, double at, Scale scale) {
  std::size_t i = 0;
  while (i + 2 < nodes.size() && at > nodes[i + 1]) ++i;
  return {i, (scale(at) - scale(nodes[i])) / (scale(nodes[i + 1]) - scale(nodes[i]))};
}

/// Share of fully developed speckle that is brighter than 1 / saturation.
double clipped_share(double saturation_ratio) {
  return saturation_ratio > 0.0 ? std::exp(-1.0 / saturation_ratio) : 0.0;
}

struct TablePlace {
  Between speckle, blur, saturation;
};

/// Figures that are powers of the speckle size and nearly exponential in blur^2 and clipped share.
template <typename Figure>
double power_law(const TablePlace& at, Figure figure) {
  double sum = 0.0;
  for (const std::size_t i : {0U, 1U}) {
    for (const std::size_t j : {0U, 1U}) {
      const double weight = (i == 1 ? at.speckle.weight : 1.0 - at.speckle.weight) *
                            (j == 1 ? at.blur.weight : 1.0 - at.blur.weight);
      sum += weight * figure(noise_table::kPatterns[at.speckle.below + i][at.blur.below + j]);
    }
  }
  return sum;
}

/// The same for figures that may be 0 and add up as squares.
template <typename Figure>
double root_of_squares(const TablePlace& at, Figure figure) {
  return std::sqrt(power_law(at, [&](const PatternNode& node) { return square(figure(node)); }));
}

// Logarithms of the figures are interpolated.
template <typename Figure>
double of_pattern(const TablePlace& at, Figure figure) {
  return std::exp(power_law(at, [&](const PatternNode& node) { return std::log(figure(node)); }));
}

template <typename Figure>
double at_saturation(const TablePlace& at, Figure figure) {
  return std::exp(power_law(at, [&](const PatternNode& node) {
    return (1.0 - at.saturation.weight) *
               std::log(figure(node.at_saturation[at.saturation.below])) +
           at.saturation.weight * std::log(figure(node.at_saturation[at.saturation.below + 1]));
  }));
}

/// One axis of the pattern as the fit sees it.
struct AxisPattern {
  double gradient_1_px2 = kUnknown;            // g
  double unclipped_gradient_1_px2 = kUnknown;  // g0
  double light_ratio = kUnknown;               // h
  double derivative_gain_1_px2 = kUnknown;     // D
  double boiling_px2 = kUnknown;               // B
  double clipping_px2 = kUnknown;              // C
  double smallest_px = kUnknown;               // I0
  double interpolation_px2 = kUnknown;         // I
};

/// The pattern with one of the two ways to treat clipped pixels.
struct FittedPattern {
  AxisPattern x, y;
  double used_ratio = 1.0;
  double spread_px2 = kUnknown;  // S
};

struct Pattern {
  FittedPattern skipping;  // pixels near clipped ones left out
  FittedPattern whole;
  double used_light_ratio = kUnknown;  // of the pixels left: mean over variance
  double variance_ratio = kUnknown;
};

using Axis = double AlongAcross::*;

AxisPattern axis_pattern(const TablePlace& at, Axis axis, ClippedFit SaturationNode::*fit) {
  const auto clipping_squared = [&](const PatternNode& node) {
    const auto one = [&](std::size_t i) {
      return square((node.at_saturation[i].*fit).clipping_px2.*axis);
    };
    return (1.0 - at.saturation.weight) * one(at.saturation.below) +
           at.saturation.weight * one(at.saturation.below + 1);
  };
  AxisPattern out;
  out.gradient_1_px2 =
      at_saturation(at, [&](const SaturationNode& n) { return (n.*fit).gradient_1_px2.*axis; });
  out.light_ratio =
      at_saturation(at, [&](const SaturationNode& n) { return (n.*fit).light_ratio.*axis; });
  out.unclipped_gradient_1_px2 = of_pattern(
      at, [&](const PatternNode& n) { return n.at_saturation[0].whole.gradient_1_px2.*axis; });
  out.derivative_gain_1_px2 =
      of_pattern(at, [&](const PatternNode& n) { return n.derivative_gain_1_px2.*axis; });
  out.boiling_px2 = of_pattern(at, [&](const PatternNode& n) { return n.boiling_px2.*axis; });
  out.clipping_px2 = std::sqrt(power_law(at, clipping_squared));
  out.smallest_px = root_of_squares(at, [&](const PatternNode& n) { return n.smallest_px.*axis; });
  out.interpolation_px2 =
      root_of_squares(at, [&](const PatternNode& n) { return n.interpolation_px2.*axis; });
  return out;
}

double saturation_ratio(const NoiseConditions& c) {
  return c.mean_signal_counts / (full_scale_counts(c.bit_depth) - c.dark_counts);
}

TablePlace table_place(const NoiseConditions& c) {
  const auto logarithm = [](double value) { return std::log(value); };
  return {
      .speckle = between(noise_table::kSpeckle_px, c.speckle_px, logarithm),
      .blur = between(noise_table::kBlur_ratio, c.blur_px / c.speckle_px, square),
      .saturation = between(noise_table::kSaturation_ratio, saturation_ratio(c), clipped_share)};
}

/// `c` must lie within the table.
Pattern pattern_of(const NoiseConditions& c) {
  const TablePlace at = table_place(c);
  const auto spread = [](const SaturationNode& n) { return n.spread_px2; };
  Pattern out;
  out.skipping = {
      .x = axis_pattern(at, &AlongAcross::x, &SaturationNode::skipping),
      .y = axis_pattern(at, &AlongAcross::y, &SaturationNode::skipping),
      .used_ratio = at_saturation(at, [](const SaturationNode& n) { return n.used_ratio; }),
      .spread_px2 = at_saturation(at, spread)};
  out.whole = {.x = axis_pattern(at, &AlongAcross::x, &SaturationNode::whole),
               .y = axis_pattern(at, &AlongAcross::y, &SaturationNode::whole),
               .used_ratio = 1.0,
               .spread_px2 = of_pattern(
                   at, [&](const PatternNode& n) { return spread(n.at_saturation[0]); })};
  out.used_light_ratio =
      at_saturation(at, [](const SaturationNode& n) { return n.used_light_ratio; });
  out.variance_ratio = at_saturation(at, [](const SaturationNode& n) { return n.variance_ratio; });
  return out;
}

// ---- the model
// -----------------------------------------------------------------------------------

/// Pixels along one side that the fit uses.
double used_side_px(int side_px, double shift_px) {
  const double beyond_px = std::floor(std::abs(shift_px));
  return side_px - 2 * kBorder_px - kBorderStep_px * std::ceil(beyond_px / kBorderStep_px);
}

double pixel_variance_counts2(const NoiseConditions& c, double light_ratio) {
  return square(c.noise_sd_counts) + kRoundingVariance_counts2 +
         light_ratio * c.mean_signal_counts / c.electrons_per_count;
}

NoiseParts parts(const NoiseConditions& c, const AxisPattern& p, double spread_px2,
                 double used_px) {
  const double v = pixel_variance_counts2(c, p.light_ratio);
  const double signal = square(c.mean_signal_counts) * p.gradient_1_px2;  // counts^2 / px^2
  const double lost = 1.0 - c.rho;
  const double f = (2.0 * p.light_ratio * c.rho * lost + lost * lost) / square(c.rho);
  NoiseParts out;
  out.noise_px = std::sqrt(2.0 * v * (1.0 + 0.5 * v * p.derivative_gain_1_px2 / signal) *
                           (1.0 + spread_px2 / used_px) / (signal * used_px));
  out.boiling_px =
      p.boiling_px2 * std::sqrt(p.unclipped_gradient_1_px2 / p.gradient_1_px2 * f / used_px);
  out.clipping_px = p.clipping_px2 / std::sqrt(used_px);
  out.interpolation_px = std::hypot(p.smallest_px, p.interpolation_px2 / std::sqrt(used_px));
  return out;
}

/// Whether the table can be asked at all.
NoiseRange table_range(const NoiseConditions& c) {
  const auto is_figure = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!is_figure(c.speckle_px) || !is_figure(c.blur_px) || !std::isfinite(c.shift_px) ||
      !is_figure(c.mean_signal_counts) || !is_figure(c.dark_counts) ||
      !is_figure(c.noise_sd_counts) || !(c.electrons_per_count > 0.0) || !is_figure(c.rho) ||
      c.rho > 1.0 || c.bit_depth < 8 || c.bit_depth > 16 ||
      c.dark_counts >= full_scale_counts(c.bit_depth))
    return NoiseRange::not_a_number;
  if (!(c.mean_signal_counts > GateConfig{}.min_signal_fraction * full_scale_counts(c.bit_depth)))
    return NoiseRange::no_light;
  for (const int side_px : {c.width_px, c.height_px})
    if (side_px < kSmallestSide_px || side_px > kLargestSide_px) return NoiseRange::window;
  if (c.speckle_px < noise_table::kSpeckle_px.front() ||
      c.speckle_px > noise_table::kSpeckle_px.back())
    return NoiseRange::speckle;
  if (c.blur_px > noise_table::kBlur_ratio.back() * c.speckle_px) return NoiseRange::blur;
  if (saturation_ratio(c) > noise_table::kSaturation_ratio.back()) return NoiseRange::saturation;
  if (c.rho < kSmallestRho) return NoiseRange::boiling;
  if (std::abs(c.shift_px) > kLargestShift * c.width_px) return NoiseRange::shift;
  return NoiseRange::inside;
}

void add_quality(const NoiseConditions& c, const Pattern& p, NoisePrediction& out) {
  const double variance = p.variance_ratio;
  const double noise = pixel_variance_counts2(c, 1.0) / square(c.mean_signal_counts);
  out.zncc = c.rho * variance / (variance + noise);
  // Squared width of the correlation peak, geometric mean over its axes.
  const double width_px2 =
      variance / std::sqrt(p.whole.x.gradient_1_px2 * p.whole.y.gradient_1_px2);
  const double overlap_px = (c.width_px - std::abs(c.shift_px)) * c.height_px;
  out.zncc_sigmas = out.zncc / std::sqrt(std::numbers::pi * width_px2 / overlap_px);
  const double noise_sd_counts = std::max(c.noise_sd_counts, std::sqrt(kRoundingVariance_counts2));
  out.contrast_to_noise = c.mean_signal_counts * std::sqrt(variance + noise) / noise_sd_counts;
}

/// `c` must lie within the table, and `pattern` be its pattern.
NoisePrediction predict(const NoiseConditions& c, const Pattern& pattern) {
  NoisePrediction out;
  add_quality(c, pattern, out);
  out.used_px = used_side_px(c.width_px, c.shift_px) * used_side_px(c.height_px, 0.0);
  const double boiling = 2.0 * (1.0 - c.rho) / c.rho * pattern.used_light_ratio;
  const FittedPattern& fit = boiling < kBoilingNotClipping ? pattern.skipping : pattern.whole;
  const GateConfig gate;
  if (out.used_px * fit.used_ratio < kFewestUsed_px)
    out.range = NoiseRange::few_pixels;
  else if (out.contrast_to_noise < gate.min_contrast_to_noise)
    out.range = NoiseRange::low_contrast;
  else if (out.zncc_sigmas < kZnccMargin * gate.min_zncc_sigmas || out.zncc < gate.min_zncc)
    out.range = NoiseRange::few_speckles;
  else
    out.range = NoiseRange::inside;
  if (out.range != NoiseRange::inside) return out;
  out.x = parts(c, fit.x, fit.spread_px2, out.used_px);
  out.y = parts(c, fit.y, fit.spread_px2, out.used_px);
  out.sigma_x_px = out.x.sigma_px();
  out.sigma_y_px = out.y.sigma_px();
  return out;
}

}  // namespace

std::string_view advice(NoiseRange range) {
  switch (range) {
    case NoiseRange::inside:
      return "within the range of the simulations";
    case NoiseRange::not_a_number:
      return "a figure is missing or negative";
    case NoiseRange::no_light:
      return "too little signal: frames would be refused as dark; expose longer";
    case NoiseRange::window:
      return "sides of 48 to 512 px were simulated";
    case NoiseRange::speckle:
      return "speckle of 2.5 to 9 px was simulated; smaller speckle aliases";
    case NoiseRange::blur:
      return "the exposure smears the pattern over more than 1.5 speckles: expose shorter";
    case NoiseRange::saturation:
      return "the mean signal is above 0.4 of full scale: too much is clipped; expose shorter";
    case NoiseRange::boiling:
      return "less than 0.5 of the pattern is left from frame to frame: raise the frame rate";
    case NoiseRange::shift:
      return "the pattern moves by more than half of the window between frames: raise the frame "
             "rate or take a larger window";
    case NoiseRange::few_pixels:
      return "nearly everything lies beside a clipped pixel: expose shorter or take a larger "
             "window";
    case NoiseRange::low_contrast:
      return "frames would be refused for low contrast: noise hides the pattern; expose longer";
    case NoiseRange::few_speckles:
      return "the correlation peak is too near to what chance reaches: take a larger window or "
             "smaller speckle, or raise the frame rate";
  }
  return "";
}

double NoiseParts::sigma_px() const {
  return std::sqrt(square(noise_px) + square(boiling_px) + square(clipping_px) +
                   square(interpolation_px));
}

NoisePrediction predict_noise(const NoiseConditions& c) {
  NoisePrediction out;
  out.range = table_range(c);
  return out.range == NoiseRange::inside ? predict(c, pattern_of(c)) : out;
}

namespace {

/// Variances of the shift of frame n against its keyframe, along one axis.
struct LinkVariance {
  double noise_px2 = 0.0;
  double boiling_px2 = 0.0;
  double model_px2 = 0.0;  // clipping and interpolation
  double sum() const { return noise_px2 + boiling_px2 + model_px2; }
};

LinkVariance link_variance(const NoiseParts& p) {
  return {square(p.noise_px), square(p.boiling_px),
          square(p.clipping_px) + square(p.interpolation_px)};
}

struct LinkVariances {
  LinkVariance x, y;
  double used_px = 0.0;
  double sum() const { return x.sum() + y.sum(); }
};

/// What the odometer expects of the next frame on the same keyframe: noise in proportion to the
/// overlap that is left, boiling as it grows (KeyframeOdometry::wants_keyframe).
double expected_px2(const LinkVariances& now, const LinkVariances& next, double overlap_ratio) {
  const double boiling_px2 = (next.x.boiling_px2 + next.y.boiling_px2) * next.used_px / now.used_px;
  return (now.sum() - now.x.boiling_px2 - now.y.boiling_px2) * overlap_ratio + boiling_px2;
}

/// Of the difference of two consecutive shifts against one keyframe: half of the noise of either is
/// the keyframe's and cancels, the pattern has boiled by what the two do not share.
double step_variance_px2(const LinkVariance& now, const LinkVariance& before) {
  return 0.5 * (now.noise_px2 + before.noise_px2) +
         std::max(0.0, now.boiling_px2 - before.boiling_px2) + now.model_px2 + before.model_px2;
}

}  // namespace

TrackingNoise predict_tracking_noise(const NoiseConditions& c) {
  TrackingNoise out;
  out.range = table_range(c);
  if (out.range != NoiseRange::inside) return out;
  const Pattern pattern = pattern_of(c);
  const auto link = [&](int frames, LinkVariances& into) {
    NoiseConditions far = c;
    far.shift_px = frames * c.shift_px;
    far.rho = std::pow(c.rho, frames);
    if (table_range(far) != NoiseRange::inside) return table_range(far);
    const NoisePrediction prediction = predict(far, pattern);
    into = {link_variance(prediction.x), link_variance(prediction.y), prediction.used_px};
    return prediction.range;
  };
  LinkVariances now;
  out.range = link(1, now);
  if (out.range != NoiseRange::inside) return out;
  double step_x_px2 = now.x.sum();
  double step_y_px2 = now.y.sum();
  int n = 1;
  for (; n < kFramesPerKeyframeLimit; ++n) {
    LinkVariances next;
    if (link(n + 1, next) != NoiseRange::inside) break;
    const double overlap_ratio =
        (c.width_px - n * std::abs(c.shift_px)) / (c.width_px - (n + 1) * std::abs(c.shift_px));
    if (expected_px2(now, next, overlap_ratio) / (n + 1) > now.sum() / n) break;
    step_x_px2 += step_variance_px2(next.x, now.x);
    step_y_px2 += step_variance_px2(next.y, now.y);
    now = next;
  }
  out.frames_per_keyframe = n;
  out.step_x_px = std::sqrt(step_x_px2 / n);
  out.step_y_px = std::sqrt(step_y_px2 / n);
  out.drift_x_px2 = now.x.sum() / n;
  out.drift_y_px2 = now.y.sum() / n;
  return out;
}

}  // namespace lsv
