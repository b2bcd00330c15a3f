// SPDX-License-Identifier: BSD-3-Clause
// Normal numbers for many pixels at little cost: eight from one draw of Philox (philox.h), each by
// sixteen bits from a table of the quantiles of the standard normal distribution. They end at 4.2
// standard deviations. Allocates at construction; any thread may draw.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace lsv::sim {

class NormalTable {
 public:
  static constexpr int kAtOnce = 8;

  NormalTable();

  /// Depends on the arguments only; stream camera_noise, counters modulo 2^32.
  void draw(std::uint64_t seed, std::int64_t i, std::int64_t j, std::int64_t k,
            std::array<float, kAtOnce>& out) const;

 private:
  std::vector<float> quantiles_;
};

}  // namespace lsv::sim
