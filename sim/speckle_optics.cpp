// SPDX-License-Identifier: BSD-3-Clause
#include "sim/speckle_optics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lsv::sim {
namespace {

using std::numbers::pi;

/// "Exponential of a semicircle" (Barnett, Magland, af Klinteberg 2019): 1 at 0, below exp(-beta)
/// from |x| = 1 on, and as compact in frequency as a Kaiser window of the same beta.
double window(double x) {
  constexpr double kBeta = 10.0;
  return std::abs(x) < 1.0 ? std::exp(kBeta * (std::sqrt(1.0 - x * x) - 1.0)) : 0.0;
}

double sinc(double x) { return x == 0.0 ? 1.0 : std::sin(pi * x) / (pi * x); }

/// Integral of the interpolation kernel over [low, high] by the midpoint rule on 1/256 sample.
double integrate_interpolation(double low, double high, double half_length) {
  const int steps = std::max(1, static_cast<int>(std::ceil((high - low) * 256.0)));
  const double step = (high - low) / steps;
  double sum = 0.0;
  for (int n = 0; n < steps; ++n) {
    const double t = low + (n + 0.5) * step;
    sum += sinc(t) * window(t / half_length);
  }
  return sum * step;
}

struct Legendre {
  double value;
  double slope;
};

Legendre legendre(int degree, double x) {
  double before = 1.0;
  double value = x;
  for (int n = 2; n <= degree; ++n) {
    const double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
    before = value;
    value = next;
  }
  return {value, degree * (x * value - before) / (x * x - 1.0)};
}

std::vector<ExposureNode> gauss_legendre(int count) {
  std::vector<ExposureNode> nodes;
  for (int n = 0; n < count; ++n) {
    double x = std::cos(pi * (n + 0.75) / (count + 0.5));
    for (int iteration = 0; iteration < 8; ++iteration) {
      const auto [value, slope] = legendre(count, x);
      x -= value / slope;
    }
    const double slope = legendre(count, x).slope;
    nodes.push_back({x / 2.0, 1.0 / ((1.0 - x * x) * slope * slope)});
  }
  return nodes;
}

}  // namespace

double point_spread(double r, double s) {
  const double x = pi * r / s;
  const double airy = x == 0.0 ? 1.0 : 2.0 * ::j1(x) / x;
  return airy * window(r / (kKernelRadius * s));
}

std::vector<double> pixel_weights(double side, double s) {
  if (side == 0.0) return {1.0};
  // The transition band of the interpolation kernel, 2 / half_length, fits between the band edge
  // of the intensity and the sampling limit.
  const double half_length = std::ceil(2.0 / (0.5 - 1.0 / s));
  const int reach = static_cast<int>(std::ceil(half_length + side / 2.0));
  std::vector<double> weights;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    const double weight = integrate_interpolation(-side / 2.0 - k, side / 2.0 - k, half_length);
    weights.push_back(weight);
    sum += weight;
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

std::vector<ExposureNode> exposure_nodes(double path, double s) {
  if (path == 0.0) return {{0.0, 1.0}};
  return gauss_legendre(4 + static_cast<int>(std::ceil(0.75 * pi * path / s)));
}

}  // namespace lsv::sim
