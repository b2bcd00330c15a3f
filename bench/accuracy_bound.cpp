// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_bound.h"

#include <algorithm>
#include <array>

namespace lsv::bench {
namespace {

// Central differences of order 2 * kReach follow the light up to its band edge.
constexpr int kReach = 8;

/// weights[n][k]: of f(x + k) - f(x - k) in the central difference that reaches n samples.
using DifferenceWeights = std::array<std::array<double, kReach + 1>, kReach + 1>;

DifferenceWeights difference_weights() {
  DifferenceWeights out{};
  for (int n = 1; n <= kReach; ++n) {
    double ratio = 1.0;  // n!^2 / ((n - k)! (n + k)!)
    for (int k = 1; k <= n; ++k) {
      ratio *= static_cast<double>(n - k + 1) / (n + k);
      const double sign = k % 2 == 1 ? 1.0 : -1.0;
      out[static_cast<std::size_t>(n)][static_cast<std::size_t>(k)] = sign * ratio / k;
    }
  }
  return out;
}

/// Derivative at sample `at` of `length` samples that lie `step` values apart.
double derivative(const double* values, int at, int length, int step) {
  static const DifferenceWeights weights = difference_weights();
  const double* here = values + static_cast<std::ptrdiff_t>(at) * step;
  const int room = std::min(at, length - 1 - at);
  if (room == 0) return at == 0 ? here[step] - here[0] : here[0] - here[-step];
  const int n = std::min(room, kReach);
  double sum = 0.0;
  for (int k = 1; k <= n; ++k) {
    sum += weights[static_cast<std::size_t>(n)][static_cast<std::size_t>(k)] *
           (here[k * step] - here[-k * step]);
  }
  return sum;
}

double pixel_variance(const sim::SpeckleConfig& camera) {
  const double sd_counts = camera.noise_sd_counts;
  double out = sd_counts * sd_counts + 1.0 / 12.0;
  if (camera.full_well_electrons)
    out += full_scale_counts(camera.bit_depth) / *camera.full_well_electrons *
           mean_signal_counts(camera);
  return out;
}

bool inside(double at, int length) { return at >= 0.0 && at <= length - 1; }

}  // namespace

ShiftBound cramer_rao_bound(const sim::SpeckleConfig& camera, const SimulatedPair& pair) {
  const int width = camera.width_px;
  const int height = camera.height_px;
  const double counts = mean_signal_counts(camera);
  const double clipped_light =
      (full_scale_counts(camera.bit_depth) - camera.noise_mean_counts) / counts;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (int y = 0; y < height; ++y) {
    if (!inside(y + pair.truth.dy_px, height)) continue;
    const double* row = pair.light.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int x = 0; x < width; ++x) {
      if (!inside(x + pair.truth.dx_px, width) || row[x] >= clipped_light) continue;
      const double gx = counts * derivative(row, x, width, 1);
      const double gy = counts * derivative(pair.light.data() + x, y, height, width);
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
    }
  }
  const double scale = 2.0 * pixel_variance(camera) / (xx * yy - xy * xy);
  return {scale * yy, scale * xx};
}

}  // namespace lsv::bench
