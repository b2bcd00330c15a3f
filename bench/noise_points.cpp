// SPDX-License-Identifier: BSD-3-Clause
#include "bench/noise_points.h"

#include <algorithm>

namespace lsv::bench {
namespace {

constexpr std::uint64_t kSeed = 777;
/// Two to four windows along each side.
int picture_side_px(int window_px) { return window_px * std::clamp(512 / window_px, 2, 4); }

/// So high that noise is not cut off at zero.
double dark_counts(double noise_sd_counts) { return std::max(3.0, 4.0 * noise_sd_counts); }

}  // namespace

const std::vector<NoisePoint>& noise_points() {
  // side, speckle, blur, mean, noise, bits, full well, rho, shift
  static const std::vector<NoisePoint> points = {
      {48, 2.5, 0.0, 45.0, 1.2, 8, 0.0, 1.0, 0.0},
      {48, 3.5, 1.0, 30.0, 0.6, 8, 8000.0, 0.97, 4.0},
      {64, 2.8, 3.0, 100.0, 0.5, 8, 0.0, 1.0, 0.0},
      {64, 5.0, 0.5, 12.0, 2.0, 8, 0.0, 1.0, 6.0},
      {96, 3.2, 0.0, 80.0, 0.3, 8, 20000.0, 1.0, 12.0},
      {96, 7.0, 2.0, 50.0, 4.0, 8, 0.0, 1.0, 0.0},
      {128, 4.4, 2.5, 60.0, 0.5, 8, 10000.0, 1.0, 20.0},
      {128, 8.0, 0.0, 40.0, 1.0, 12, 0.0, 0.9, 0.0},
      {128, 3.3, 1.5, 100.0, 0.3, 12, 12000.0, 1.0, 0.0},
      {192, 2.6, 0.8, 60.0, 0.5, 8, 0.0, 0.999, 28.0},
      {256, 5.5, 3.0, 70.0, 0.8, 12, 30000.0, 0.7, 0.0},
      {256, 3.1, 0.0, 90.0, 3.0, 8, 0.0, 1.0, 25.0},
  };
  return points;
}

NoiseConditions conditions_of(const NoisePoint& p) {
  NoiseConditions out;
  out.width_px = out.height_px = p.side_px;
  out.speckle_px = p.speckle_px;
  out.blur_px = p.blur_px;
  out.shift_px = p.shift_px;
  out.mean_signal_counts = p.mean_counts;
  out.dark_counts = dark_counts(p.noise_sd_counts);
  out.noise_sd_counts = p.noise_sd_counts;
  if (p.full_well_electrons > 0.0)
    out.electrons_per_count = p.full_well_electrons / full_scale_counts(p.bit_depth);
  out.bit_depth = p.bit_depth;
  out.rho = p.rho;
  return out;
}

sim::SpeckleConfig camera_of(const NoisePoint& p) {
  sim::SpeckleConfig out;
  out.width_px = out.height_px = p.side_px;
  out.speckle_px = p.speckle_px;
  out.exposure_ratio = 1.0;
  out.rho = p.rho;
  out.bit_depth = p.bit_depth;
  out.mean_signal_counts = p.mean_counts;
  out.noise_mean_counts = dark_counts(p.noise_sd_counts);
  out.noise_sd_counts = p.noise_sd_counts;
  if (p.full_well_electrons > 0.0) out.full_well_electrons = p.full_well_electrons;
  out.seed = kSeed;
  return out;
}

LightSetup light_of(const NoisePoint& p) {
  return {.speckle_px = p.speckle_px,
          .blur_px = p.blur_px,
          .shift_px = p.shift_px,
          .rho = p.rho,
          .side_px = picture_side_px(p.side_px),
          .seed = kSeed};
}

PairErrors simulate(const NoisePoint& point, int pairs) {
  return measure_pairs(light_of(point), camera_of(point), pairs);
}

}  // namespace lsv::bench
