// SPDX-License-Identifier: BSD-3-Clause
#include "bench/noise_light.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "bench/accuracy_pair.h"
#include "correlation/tracker.h"
#include "sim/speckle.h"

namespace lsv::bench {
namespace {

using noise_table::AlongAcross;

constexpr int kBlock_px = 96;
constexpr int kSide_px = 8 * kBlock_px + 2 * kGradientReach_px;
constexpr int kBits = 16;
constexpr std::uint64_t kSeed = 20261125;

struct Moments {
  double n = 0.0, sum = 0.0, squares = 0.0;
  void add(double value) {
    n += 1.0;
    sum += value;
    squares += value * value;
  }
  double mean() const { return sum / n; }
  double variance() const { return squares / n - mean() * mean(); }
  double relative_variance() const { return variance() / (mean() * mean()); }
};

/// Sums of squared gradients, plain and times the light.
struct GradientSums {
  AlongAcross squares, lit;
  void add(double gx, double gy, double light) {
    squares.x += gx * gx;
    squares.y += gy * gy;
    lit.x += gx * gx * light;
    lit.y += gy * gy * light;
  }
};

double derivative_gain(const SpeckleKernel& kernel) {
  double out = 0.0;
  for (const float d : kernel.derivative_1_px()) out += 2.0 * static_cast<double>(d) * d;
  return out;
}

/// The sums of a pattern at one saturation, in the units of the table.
class LightMeter {
 public:
  explicit LightMeter(double saturation_ratio)
      : mean_counts_(full_scale_counts(kBits) * saturation_ratio),
        format_{.width_px = kSide_px,
                .height_px = kSide_px,
                .type = PixelType::mono16,
                .bit_depth = kBits},
        tracker_(format_, Refinement::icgn, 0.0),
        frame_(format_),
        reference_(format_) {
    picture_.reset(format_);
  }

  void add(const std::vector<double>& light) {
    sim::to_counts({.mean_signal_counts = mean_counts_}, 0, light, picture_);
    frame_.load(picture_.view());
    tracker_.build(frame_, reference_);
    const int end_px = kSide_px - kGradientReach_px;
    for (int top = kGradientReach_px; top < end_px; top += kBlock_px)
      for (int left = kGradientReach_px; left < end_px; left += kBlock_px) add_block(left, top);
  }

  noise_table::SaturationNode node() const {
    noise_table::SaturationNode out;
    fill(whole_, out.whole);
    fill(skipping_, out.skipping);
    out.variance_ratio = light_.variance();
    out.used_ratio = used_light_.n / light_.n;
    out.used_light_ratio = used_light_.mean() / used_light_.variance();
    out.spread_px2 =
        0.5 * (block_x_.relative_variance() + block_y_.relative_variance()) * kBlock_px * kBlock_px;
    return out;
  }

  AlongAcross derivative_gain_1_px2() const {
    return {derivative_gain(reference_.kernel_x()), derivative_gain(reference_.kernel_y())};
  }

 private:
  void add_block(int left_px, int top_px) {
    const kernels::ReferencePlanes planes = reference_.planes(true);
    AlongAcross block;
    for (int y = top_px; y < top_px + kBlock_px; ++y) {
      for (int x = left_px; x < left_px + kBlock_px; ++x) {
        const double gx = *planes.gx.at(x, y) / mean_counts_;
        const double gy = *planes.gy.at(x, y) / mean_counts_;
        const int counts = picture_.row16(y)[x];
        const double light = counts / mean_counts_;
        light_.add(light);
        // A clipped pixel has no shot noise.
        whole_.add(gx, gy, counts >= full_scale_counts(kBits) ? 0.0 : light);
        if (*planes.value.at(x, y) == kernels::kUnused) continue;
        used_light_.add(light);
        skipping_.add(gx, gy, light);
        block.x += gx * gx;
        block.y += gy * gy;
      }
    }
    block_x_.add(block.x);
    block_y_.add(block.y);
  }

  void fill(const GradientSums& sums, noise_table::ClippedFit& out) const {
    out.gradient_1_px2 = {sums.squares.x / light_.n, sums.squares.y / light_.n};
    out.light_ratio = {sums.lit.x / sums.squares.x, sums.lit.y / sums.squares.y};
  }

  double mean_counts_;
  FrameFormat format_;
  Tracker tracker_;
  TrackFrame frame_;
  TrackReference reference_;
  Frame picture_;
  GradientSums whole_, skipping_;
  Moments light_, used_light_, block_x_, block_y_;
};

}  // namespace

PatternLight measure_light(double speckle_px, double blur_px, double faint_ratio, int pictures) {
  std::vector<LightMeter> meters;
  for (const double saturation_ratio : noise_table::kSaturation_ratio)
    meters.emplace_back(std::max(saturation_ratio, faint_ratio));
  sim::SpeckleConfig config;
  config.width_px = config.height_px = kSide_px;
  config.speckle_px = speckle_px;
  config.exposure_ratio = 1.0;
  std::vector<double> light;
  for (int i = 0; i < pictures; ++i) {
    config.seed = kSeed + static_cast<std::uint64_t>(i);
    sim::SpeckleCamera camera = require_value(sim::SpeckleCamera::create(config));
    const Result<void> done = camera.render_intensity(0, {0.0, 0.0, blur_px, 0.0}, light);
    if (!done) throw std::runtime_error(done.error().message);
    for (LightMeter& meter : meters) meter.add(light);
  }
  PatternLight out;
  for (std::size_t i = 0; i < meters.size(); ++i) out.at_saturation[i] = meters[i].node();
  out.derivative_gain_1_px2 = meters.front().derivative_gain_1_px2();
  return out;
}

}  // namespace lsv::bench
