// SPDX-License-Identifier: BSD-3-Clause
#include "sim/normal_table.h"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "sim/philox.h"

namespace lsv::sim {
namespace {

constexpr std::size_t kQuantiles = 65536;

/// x with P(normal < x) = p, for p >= 1/2, by Newton steps from `near`.
double quantile(double p, double near) {
  double x = near;
  for (int step = 0; step < 6; ++step) {
    const double above = 0.5 * std::erfc(x / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    x += (above - (1.0 - p)) / density;
  }
  return x;
}

}  // namespace

NormalTable::NormalTable() : quantiles_(kQuantiles) {
  double x = 0.0;
  for (std::size_t n = kQuantiles / 2; n < kQuantiles; ++n) {
    x = quantile((static_cast<double>(n) + 0.5) / kQuantiles, x);
    quantiles_[n] = static_cast<float>(x);
    quantiles_[kQuantiles - 1 - n] = static_cast<float>(-x);
  }
}

void NormalTable::draw(std::uint64_t seed, std::int64_t i, std::int64_t j, std::int64_t k,
                       std::array<float, kAtOnce>& out) const {
  const PhiloxWords words =
      philox4x32({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j),
                  static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(Stream::camera_noise)},
                 seed);
  for (std::size_t n = 0; n < words.size(); ++n) {
    out[2 * n] = quantiles_[words[n] & 0xFFFFU];
    out[2 * n + 1] = quantiles_[words[n] >> 16];
  }
}

}  // namespace lsv::sim
