// SPDX-License-Identifier: BSD-3-Clause
// Simulates the numbers of calibration/noise_model.h:
//   noise_table FILE      writes FILE, calibration/noise_table.cpp of the repository
// About an hour on one processor; the same numbers on every run of one machine.
#include "calibration/noise_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "bench/noise_light.h"
#include "bench/noise_pairs.h"
#include "lsv/output/number_text.h"
#include "lsv/output/output_file.h"

namespace lsv::bench {
namespace {

using namespace noise_table;

constexpr int kPictures = 4;  // for the gradients
constexpr int kBoilingPairs = 1600;
constexpr int kClippingPairs = 800;
constexpr int kSmallPairs = 1000;
constexpr int kLargePairs = 320;
constexpr int kSide_px = 128;
constexpr int kSmallSide_px = 96;
constexpr int kLargeSide_px = 256;
// Little enough that nothing is clipped, and boiling enough that nothing else counts.
constexpr double kFaint_ratio = 0.02;
constexpr double kRho = 0.99;
constexpr std::uint64_t kSeed = 20261125;

double used_px(int side_px) {
  return static_cast<double>(side_px - 2 * kGradientReach_px) * (side_px - 2 * kGradientReach_px);
}

/// 16 bit and no noise: rounding is felt nowhere.
sim::SpeckleConfig noise_free_camera(int side_px, double saturation_ratio) {
  sim::SpeckleConfig out;
  out.width_px = out.height_px = side_px;
  out.bit_depth = 16;
  out.mean_signal_counts = full_scale_counts(16) * saturation_ratio;
  out.noise_mean_counts = 0.0;
  out.noise_sd_counts = 0.0;
  return out;
}

void require_good(const PairErrors& errors) {
  if (errors.outliers > errors.pairs / 100)
    throw std::runtime_error("more than 1 % of the pairs were not measured");
}

AlongAcross squared_errors(const PairErrors& errors) {
  require_good(errors);
  return {errors.squares_x_px2 / errors.good(), errors.squares_y_px2 / errors.good()};
}

double excess(double squared, double known_squared, double pixels) {
  return std::sqrt(std::max(0.0, squared - known_squared) * pixels);
}

/// What is left without noise and boiling: interpolation, and what clipping adds to it.
void measure_floor(const LightSetup& setup, PatternNode& out) {
  LightPairs light(setup);
  PairMeter faint(noise_free_camera(kSide_px, kFaint_ratio));
  PairMeter small(noise_free_camera(kSmallSide_px, kFaint_ratio));
  PairMeter large(noise_free_camera(kLargeSide_px, kFaint_ratio));
  std::vector<PairMeter> skipping, whole;
  for (std::size_t i = 1; i < kSaturations; ++i) {
    skipping.emplace_back(noise_free_camera(kSide_px, kSaturation_ratio[i]));
    whole.emplace_back(noise_free_camera(kSide_px, kFaint_ratio), 1.0 / kSaturation_ratio[i]);
  }
  const auto more = [](PairMeter& meter, const LightPair& pair, int pairs) {
    meter.measure(pair, pairs - meter.errors().pairs);
  };
  while (large.errors().pairs < kLargePairs) {
    const LightPair& pair = light.next();
    more(faint, pair, kClippingPairs);
    more(small, pair, kSmallPairs);
    more(large, pair, kLargePairs);
    for (PairMeter& meter : skipping) more(meter, pair, kClippingPairs);
    for (PairMeter& meter : whole) more(meter, pair, kClippingPairs);
  }
  const AlongAcross in_small = squared_errors(small.errors());
  const AlongAcross in_large = squared_errors(large.errors());
  const AlongAcross in_middle = squared_errors(faint.errors());
  // error^2 = smallest^2 + interpolation^2 / N, from two windows.
  const auto solve = [&](double s, double l, double& smallest_px, double& interpolation_px2) {
    const double per_px = 1.0 / used_px(kSmallSide_px) - 1.0 / used_px(kLargeSide_px);
    const double falling = std::max(0.0, s - l) / per_px;
    interpolation_px2 = std::sqrt(falling);
    smallest_px = std::sqrt(std::max(0.0, l - falling / used_px(kLargeSide_px)));
  };
  solve(in_small.x, in_large.x, out.smallest_px.x, out.interpolation_px2.x);
  solve(in_small.y, in_large.y, out.smallest_px.y, out.interpolation_px2.y);
  for (std::size_t i = 1; i < kSaturations; ++i) {
    const AlongAcross s = squared_errors(skipping[i - 1].errors());
    const AlongAcross w = squared_errors(whole[i - 1].errors());
    const double pixels = used_px(kSide_px);
    out.at_saturation[i].skipping.clipping_px2 = {excess(s.x, in_middle.x, pixels),
                                                  excess(s.y, in_middle.y, pixels)};
    out.at_saturation[i].whole.clipping_px2 = {excess(w.x, in_middle.x, pixels),
                                               excess(w.y, in_middle.y, pixels)};
  }
}

void measure_boiling(LightSetup setup, PatternNode& out) {
  setup.rho = kRho;
  const AlongAcross squared = squared_errors(
      measure_pairs(setup, noise_free_camera(kSide_px, kFaint_ratio), kBoilingPairs));
  const AlongAcross& light = out.at_saturation[0].whole.light_ratio;
  const auto strength = [&](double squared_px2, double light_ratio) {
    const double f =
        (2.0 * light_ratio * kRho * (1.0 - kRho) + (1.0 - kRho) * (1.0 - kRho)) / (kRho * kRho);
    return std::sqrt(squared_px2 * used_px(kSide_px) / f);
  };
  out.boiling_px2 = {strength(squared.x, light.x), strength(squared.y, light.y)};
}

PatternNode measure_pattern(double speckle_px, double blur_ratio) {
  PatternNode out;
  const double blur_px = blur_ratio * speckle_px;
  const PatternLight light = measure_light(speckle_px, blur_px, kFaint_ratio, kPictures);
  out.at_saturation = light.at_saturation;
  out.derivative_gain_1_px2 = light.derivative_gain_1_px2;
  const LightSetup setup{.speckle_px = speckle_px, .blur_px = blur_px, .seed = kSeed};
  measure_floor(setup, out);
  measure_boiling(setup, out);
  return out;
}

// ---- the source file --------------------------------------------------------------------------

void append(std::string& out, const AlongAcross& pair) {
  out += formatted("{%.4g, %.4g}, ", pair.x, pair.y);
}

void append(std::string& out, const ClippedFit& fit) {
  out += '{';
  append(out, fit.gradient_1_px2);
  append(out, fit.light_ratio);
  append(out, fit.clipping_px2);
  out += "}, ";
}

void append(std::string& out, const SaturationNode& node) {
  out += '{';
  append(out, node.whole);
  append(out, node.skipping);
  out += formatted("%.4g, %.4g, %.4g, %.4g},\n", node.variance_ratio, node.used_ratio,
                   node.used_light_ratio, node.spread_px2);
}

void append(std::string& out, const PatternNode& node) {
  out += '{';
  append(out, node.boiling_px2);
  append(out, node.smallest_px);
  append(out, node.interpolation_px2);
  append(out, node.derivative_gain_1_px2);
  out += "{{\n";
  for (const SaturationNode& at : node.at_saturation) append(out, at);
  out += "}}},\n";
}

std::string simulate() {
  std::string out =
      "// SPDX-License-Identifier: BSD-3-Clause\n"
      "// Written by bench/noise_table.cpp; what the numbers are: noise_table.h.\n"
      "#include \"calibration/noise_table.h\"\n\n"
      "namespace lsv::noise_table {\n\n"
      "// clang-format off\n"
      "const std::array<std::array<PatternNode, kBlurs>, kSpeckles> kPatterns = {{\n";
  for (const double speckle_px : kSpeckle_px) {
    out += "{{";
    for (const double blur_ratio : kBlur_ratio) {
      out += formatted("// speckle %g px, blur %g of it\n", speckle_px, blur_ratio);
      std::string node;
      append(node, measure_pattern(speckle_px, blur_ratio));
      out += node;
      std::fprintf(stderr, "// speckle %g px, blur %g of it\n%s", speckle_px, blur_ratio,
                   node.c_str());
    }
    out += "}},\n";
  }
  return out + "}};\n// clang-format on\n\n}  // namespace lsv::noise_table\n";
}

}  // namespace
}  // namespace lsv::bench

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: noise_table FILE\n", stderr);
    return 2;
  }
  try {
    cv::setNumThreads(1);
    const lsv::Result<void> written = lsv::write_file(argv[1], lsv::bench::simulate());
    if (!written) throw std::runtime_error(written.error().message);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "noise_table: %s\n", error.what());
    return 2;
  }
}
