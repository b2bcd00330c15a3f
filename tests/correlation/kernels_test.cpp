// SPDX-License-Identifier: BSD-3-Clause
// Every kernel on every instruction set of this machine, scalar included, against kernels_ref.h.
#include "correlation/kernels.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "correlation/kernels_ref.h"

namespace lsv::kernels {
namespace {

constexpr std::size_t kLengths[] = {1, 2, 3, 7, 8, 15, 16, 17, 31, 33, 64, 127, 128, 1061};

std::vector<std::int64_t> all_targets() {
  std::vector<std::int64_t> out;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) out.push_back(target);
  return out;
}

/// Runs each test with one instruction set forced and proves that it is the one in force.
class KernelsTest : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override {
    hwy::SetSupportedTargetsForTest(GetParam());
    ASSERT_EQ(simd_target(), hwy::TargetName(GetParam()));
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  template <typename T>
  std::vector<T> random_counts(std::size_t n, unsigned highest) {
    std::vector<T> out(n);
    for (T& value : out) value = static_cast<T>(random_() % (highest + 1));
    return out;
  }
  std::vector<float> random_floats(std::size_t n) {
    std::vector<float> out(n);
    for (float& value : out) value = static_cast<float>(random_() % 20001) / 10000.0F - 1.0F;
    return out;
  }

  std::mt19937 random_{20260101};
};

TEST_P(KernelsTest, RowSums8) {
  for (const std::size_t n : kLengths) {
    const auto row = random_counts<std::uint8_t>(n, 255);
    const RowSums got = row_sums(row.data(), n, std::uint8_t{200});
    const RowSums want = ref::row_sums(row.data(), n, std::uint8_t{200});
    EXPECT_EQ(got.sum_counts, want.sum_counts) << n;
    EXPECT_EQ(got.saturated, want.saturated) << n;
  }
}

TEST_P(KernelsTest, RowSums16HoldsAFullScaleRow) {
  for (const std::size_t n : {std::size_t{5}, std::size_t{128}, std::size_t{200003}}) {
    const std::vector<std::uint16_t> row(n, 65535);
    const RowSums got = row_sums(row.data(), n, std::uint16_t{65535});
    EXPECT_EQ(got.sum_counts, 65535ULL * n);
    EXPECT_EQ(got.saturated, n);
  }
  const auto row = random_counts<std::uint16_t>(777, 4095);
  EXPECT_EQ(row_sums(row.data(), 777, std::uint16_t{4095}).sum_counts,
            ref::row_sums(row.data(), 777, std::uint16_t{4095}).sum_counts);
}

TEST_P(KernelsTest, CentreIsExact) {
  for (const std::size_t n : kLengths) {
    const auto row8 = random_counts<std::uint8_t>(n, 255);
    const auto row16 = random_counts<std::uint16_t>(n, 65535);
    std::vector<float> got(n), want(n);
    centre(row8.data(), n, 61.37F, got.data());
    ref::centre(row8.data(), n, 61.37F, want.data());
    EXPECT_EQ(got, want) << n;
    centre(row16.data(), n, 1234.5F, got.data());
    ref::centre(row16.data(), n, 1234.5F, want.data());
    EXPECT_EQ(got, want) << n;
  }
}

TEST_P(KernelsTest, AccumulateColumnsIsExact) {
  for (const std::size_t n : kLengths) {
    std::vector<double> sum(n, 0.25), sum_sq(n, 0.5);
    std::vector<double> want_sum = sum, want_sum_sq = sum_sq;
    const auto stride = static_cast<std::ptrdiff_t>(n + 3);
    for (const auto& [rows, sign] : {std::pair{1U, 1.0}, {8U, 1.0}, {3U, -1.0}}) {
      const auto image = random_floats((n + 3) * rows);
      accumulate_columns(image.data(), stride, rows, n, sign, sum.data(), sum_sq.data());
      ref::accumulate_columns(image.data(), stride, rows, n, sign, want_sum.data(),
                              want_sum_sq.data());
    }
    EXPECT_EQ(sum, want_sum) << n;
    EXPECT_EQ(sum_sq, want_sum_sq) << n;
  }
}

TEST_P(KernelsTest, OverlapTermsAreExact) {
  for (const std::size_t n : kLengths) {
    std::vector<double> sum(n), sum_sq(n), inv_root_cols(n);
    for (std::size_t i = 0; i < n; ++i) {
      sum[i] = static_cast<double>(random_() % 1000) - 500.0;
      sum_sq[i] = static_cast<double>(random_() % 100000);
      inv_root_cols[i] = 1.0 / std::sqrt(1.0 + static_cast<double>(random_() % 100));
    }
    std::vector<float> root(n), norm(n), want_root(n), want_norm(n);
    overlap_terms(sum.data(), sum_sq.data(), inv_root_cols.data(), 0.1, 100.0, n, root.data(),
                  norm.data());
    ref::overlap_terms(sum.data(), sum_sq.data(), inv_root_cols.data(), 0.1, 100.0, n,
                       want_root.data(), want_norm.data());
    EXPECT_EQ(root, want_root) << n;
    EXPECT_EQ(norm, want_norm) << n;
    EXPECT_NEAR(kernels::sum(sum.data(), n), ref::sum(sum.data(), n), 1e-9) << n;
  }
}

TEST_P(KernelsTest, InterleaveAndDeinterleaveAreExact) {
  for (const std::size_t n : kLengths) {
    const auto re = random_floats(n), im = random_floats(n);
    std::vector<std::complex<float>> got(n), want(n);
    interleave(re.data(), im.data(), n, got.data());
    ref::interleave(re.data(), im.data(), n, want.data());
    EXPECT_EQ(got, want) << n;
    std::vector<float> got_re(n), got_im(n);
    deinterleave(want.data(), n, got_re.data(), got_im.data());
    EXPECT_EQ(got_re, re) << n;
    EXPECT_EQ(got_im, im) << n;
  }
}

TEST_P(KernelsTest, PairSpectraAreExactAndComeBack) {
  for (const std::size_t n : {2U, 4U, 6U, 12U, 20U, 96U, 160U, 1280U}) {
    constexpr std::size_t kStride = 5;
    std::vector<std::complex<float>> z(n), back(n), want_back(n);
    const auto parts = random_floats(2 * n);
    interleave(parts.data(), parts.data() + n, n, z.data());
    std::vector<std::complex<float>> got((n / 2 + 1) * kStride), want(got.size());
    unpack_pair_spectrum(z.data(), n, kStride, got.data());
    ref::unpack_pair_spectrum(z.data(), n, kStride, want.data());
    EXPECT_EQ(got, want) << n;
    pack_pair_spectrum(want.data(), kStride, n, back.data());
    ref::pack_pair_spectrum(want.data(), kStride, n, want_back.data());
    EXPECT_EQ(back, want_back) << n;
    for (std::size_t k = 0; k < n; ++k) EXPECT_NEAR(std::abs(back[k] - z[k]), 0.0, 3e-7) << k;
  }
}

TEST_P(KernelsTest, MultiplyConjIsExactAndMayWorkInPlace) {
  for (const std::size_t n : kLengths) {
    std::vector<std::complex<float>> a(n), b(n), got(n), want(n);
    const auto parts = random_floats(4 * n);
    for (std::size_t i = 0; i < n; ++i) {
      a[i] = {parts[4 * i], parts[4 * i + 1]};
      b[i] = {parts[4 * i + 2], parts[4 * i + 3]};
    }
    ref::multiply_conj(a.data(), b.data(), n, want.data());
    multiply_conj(a.data(), b.data(), n, got.data());
    EXPECT_EQ(got, want) << n;
    multiply_conj(a.data(), b.data(), n, b.data());
    EXPECT_EQ(b, want) << n;
  }
}

TEST_P(KernelsTest, NormaliseOverlapIsExact) {
  for (const std::size_t n : kLengths) {
    auto got = random_floats(n);
    auto want = got;
    const auto mean_a = random_floats(n), norm_a = random_floats(n);
    const auto mean_b = random_floats(n), norm_b = random_floats(n);
    normalise_overlap(got.data(), n, 0.37F, mean_a.data(), norm_a.data(), mean_b.data(),
                      norm_b.data());
    ref::normalise_overlap(want.data(), n, 0.37F, mean_a.data(), norm_a.data(), mean_b.data(),
                           norm_b.data());
    EXPECT_EQ(got, want) << n;
  }
}

TEST_P(KernelsTest, MaxValueFindsTheMaximumAnywhere) {
  for (const std::size_t n : kLengths) {
    std::vector<float> values(n, -2.0F);
    for (std::size_t i = 0; i < n; ++i) {
      values[i] = -1.0F;
      EXPECT_EQ(max_value(values.data(), n), -1.0F) << i << " of " << n;
      values[i] = -2.0F;
    }
  }
}

TEST_P(KernelsTest, SumsAgreeToDoubleRounding) {
  for (const std::size_t n : kLengths) {
    const auto values = random_floats(n);
    const AbsAndSquares got = sum_abs_and_squares(values.data(), n);
    const AbsAndSquares want = ref::sum_abs_and_squares(values.data(), n);
    const double rounding = 1e-15 * static_cast<double>(n);
    EXPECT_NEAR(got.sum_abs, want.sum_abs, rounding * want.sum_abs + 1e-300) << n;
    EXPECT_NEAR(got.sum_squares, want.sum_squares, rounding * want.sum_squares + 1e-300) << n;
  }
}

INSTANTIATE_TEST_SUITE_P(EveryTarget, KernelsTest, testing::ValuesIn(all_targets()),
                         [](const auto& target) {
                           return std::string(hwy::TargetName(target.param));
                         });

}  // namespace
}  // namespace lsv::kernels
