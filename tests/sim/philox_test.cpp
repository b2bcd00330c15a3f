// SPDX-License-Identifier: BSD-3-Clause
#include "sim/philox.h"

#include <gtest/gtest.h>

namespace lsv::sim {
namespace {

// Known answers of Random123 (kat_vectors, philox4x32 with 10 rounds).
TEST(Philox, GivesThePublishedNumbers) {
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, 0),
            (PhiloxWords{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({~0U, ~0U, ~0U, ~0U}, ~std::uint64_t{0}),
            (PhiloxWords{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, 0x299f31d0a4093822),
            (PhiloxWords{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Philox, EveryCounterStreamAndSeedMatters) {
  const auto base = uniform_pair(1, Stream::ground, 2, 3, 4);
  EXPECT_EQ(base, uniform_pair(1, Stream::ground, 2, 3, 4));
  EXPECT_NE(base, uniform_pair(2, Stream::ground, 2, 3, 4));
  EXPECT_NE(base, uniform_pair(std::uint64_t{1} | std::uint64_t{1} << 40, Stream::ground, 2, 3, 4));
  EXPECT_NE(base, uniform_pair(1, Stream::boiling, 2, 3, 4));
  EXPECT_NE(base, uniform_pair(1, Stream::ground, -2, 3, 4));
  EXPECT_NE(base, uniform_pair(1, Stream::ground, 2, -3, 4));
  EXPECT_NE(base, uniform_pair(1, Stream::ground, 2, 3, 5));
}

TEST(Philox, ComplexNormalIsCircularWithUnitPower) {
  constexpr int kSide = 400;
  std::complex<double> sum;
  std::complex<double> sum_of_squares;
  std::complex<double> neighbours;
  double power = 0.0;
  double power_squared = 0.0;
  std::complex<double> before;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const auto z = complex_normal(7, Stream::ground, i, j, 0);
      sum += z;
      sum_of_squares += z * z;
      neighbours += z * std::conj(before);
      power += std::norm(z);
      power_squared += std::norm(z) * std::norm(z);
      before = z;
    }
  }
  constexpr double kCount = double{kSide} * kSide;
  const double five_sigma = 5.0 / std::sqrt(kCount);
  EXPECT_LT(std::abs(sum) / kCount, five_sigma);
  EXPECT_LT(std::abs(sum_of_squares) / kCount, 2.0 * five_sigma);
  EXPECT_LT(std::abs(neighbours) / kCount, five_sigma);
  EXPECT_NEAR(power / kCount, 1.0, five_sigma);
  EXPECT_NEAR(power_squared / kCount, 2.0, std::sqrt(20.0) * five_sigma);
}

}  // namespace
}  // namespace lsv::sim
