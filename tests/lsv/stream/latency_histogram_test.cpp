// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/latency_histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace lsv {
namespace {

TEST(LatencyHistogram, EmptyIsUnknown) {
  const LatencySummary none = LatencyHistogram().summary();
  EXPECT_EQ(none.count, 0);
  EXPECT_TRUE(std::isnan(none.p50_s));
  EXPECT_TRUE(std::isnan(none.max_s));
}

TEST(LatencyHistogram, QuantilesAreWithinOnePercentOfTheSorted) {
  constexpr unsigned kSeed = 11;
  std::mt19937_64 random(kSeed);
  // Over all the octaves, evenly in the logarithm.
  std::uniform_real_distribution<double> exponent(0.0, std::log(2e12));
  LatencyHistogram histogram;
  std::vector<double> all_s;
  for (int i = 0; i < 50'000; ++i) {
    const auto taken_ns = static_cast<std::int64_t>(std::exp(exponent(random)));
    histogram.add(taken_ns);
    all_s.push_back(1e-9 * static_cast<double>(taken_ns));
  }
  std::sort(all_s.begin(), all_s.end());
  const auto exact_s = [&](double share) {
    return all_s[static_cast<std::size_t>(std::ceil(share * 50'000)) - 1];
  };
  const LatencySummary found = histogram.summary();
  EXPECT_EQ(found.count, 50'000);
  EXPECT_NEAR(found.p50_s, exact_s(0.5), 0.01 * exact_s(0.5)) << "seed " << kSeed;
  EXPECT_NEAR(found.p99_s, exact_s(0.99), 0.01 * exact_s(0.99));
  EXPECT_NEAR(found.p999_s, exact_s(0.999), 0.01 * exact_s(0.999));
  EXPECT_DOUBLE_EQ(found.max_s, all_s.back());
}

TEST(LatencyHistogram, EveryDurationFindsABinThatHoldsIt) {
  for (std::int64_t taken_ns = 1; taken_ns < std::int64_t{1} << 42; taken_ns += 1 + taken_ns / 7) {
    LatencyHistogram histogram;
    histogram.add(taken_ns);
    histogram.add(std::int64_t{1} << 42);  // so that the maximum does not bound the quantile
    const double taken_s = 1e-9 * static_cast<double>(taken_ns);
    ASSERT_NEAR(histogram.summary().p50_s, taken_s, 0.01 * taken_s);
  }
}

TEST(LatencyHistogram, TakesWhatCannotBe) {
  LatencyHistogram histogram;
  histogram.add(-5);
  EXPECT_EQ(histogram.summary().p50_s, 0.0);
  histogram.add(INT64_MAX);
  EXPECT_EQ(histogram.summary().count, 2);
}

}  // namespace
}  // namespace lsv
