// SPDX-License-Identifier: BSD-3-Clause
#include "sim/tap_weights.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace lsv::sim {
namespace {

using Row = std::array<double, kTaps>;

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

/// Lower triangle L of the Gram matrix of the taps, L L' = G.
std::array<Row, kTaps> gram_root(double band_edge) {
  std::array<Row, kTaps> root{};
  for (std::size_t i = 0; i < kTaps; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double left = sinc(2.0 * band_edge * static_cast<double>(i - j));
      for (std::size_t k = 0; k < j; ++k) left -= root[i][k] * root[j][k];
      root[i][j] = i == j ? std::sqrt(left) : left / root[j][j];
    }
  }
  return root;
}

/// Solves L L' x = b in place.
void solve(const std::array<Row, kTaps>& root, Row& b) {
  for (std::size_t i = 0; i < kTaps; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= root[i][k] * b[k];
    b[i] /= root[i][i];
  }
  for (std::size_t i = kTaps; i-- > 0;) {
    for (std::size_t k = i + 1; k < kTaps; ++k) b[i] -= root[k][i] * b[k];
    b[i] /= root[i][i];
  }
}

}  // namespace

std::vector<TapWeights> tap_weights(int number, double band_edge) {
  const std::array<Row, kTaps> root = gram_root(band_edge);
  std::vector<TapWeights> out;
  for (int n = 0; n < number; ++n) {
    const double place = static_cast<double>(n) / (number - 1) + 2.0;  // from the first tap
    Row weights{};
    for (std::size_t k = 0; k < kTaps; ++k)
      weights[k] = sinc(2.0 * band_edge * (place - static_cast<double>(k)));
    solve(root, weights);
    TapWeights& stored = out.emplace_back();
    for (std::size_t k = 0; k < kTaps; ++k) stored[k] = static_cast<float>(weights[k]);
  }
  return out;
}

}  // namespace lsv::sim
