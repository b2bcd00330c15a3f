// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/slip_cusum.h"

#include <gtest/gtest.h>

#include <random>

namespace lsv::fusion {
namespace {

constexpr SlipConfig kConfig{};
constexpr double kRim_m_s = 0.055;
constexpr double kSigma_m_s = 0.0018;

/// Samples until the alarm is `wanted`; -1: never within 1000.
int samples_until(SlipCusum& cusum, bool wanted, double rim_m_s, double ground_m_s) {
  for (int i = 0; i < 1000; ++i) {
    if (cusum.alarm() == wanted) return i;
    cusum.add(kConfig, rim_m_s, ground_m_s, kSigma_m_s);
  }
  return -1;
}

TEST(SlipCusum, TellsSlipAndItsEndBothWays) {
  for (const double way : {1.0, -1.0}) {
    SlipCusum cusum;
    EXPECT_LE(samples_until(cusum, true, way * kRim_m_s, way * 0.5 * kRim_m_s), 2);
    EXPECT_TRUE(cusum.alarm());
    EXPECT_LE(samples_until(cusum, false, way * kRim_m_s, way * kRim_m_s), 4);
    EXPECT_FALSE(cusum.alarm());
  }
}

TEST(SlipCusum, LessThanTheLimitIsNotTold) {
  SlipCusum cusum;
  EXPECT_EQ(samples_until(cusum, true, kRim_m_s, 0.87 * kRim_m_s), -1);
}

// A vehicle that is faster than its wheels is pulled: that is for the other sum to tell.
TEST(SlipCusum, TellsOneOfSpinningAndSkidding) {
  SlipCusum spins, skids;
  EXPECT_EQ(samples_until(spins, true, kRim_m_s, 2.0 * kRim_m_s), -1);
  EXPECT_LE(samples_until(skids, true, 2.0 * kRim_m_s, kRim_m_s), 2);
  EXPECT_TRUE(skids.alarm());
}

TEST(SlipCusum, NoiseAtRestAndAtSpeedRaisesNoAlarm) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, kSigma_m_s);
  for (const double rim_m_s : {0.0, 0.003, kRim_m_s}) {
    SlipCusum cusum;
    int alarms = 0;
    for (int i = 0; i < 100'000; ++i) {
      cusum.add(kConfig, rim_m_s + noise(random), rim_m_s, kSigma_m_s);
      alarms += cusum.alarm() ? 1 : 0;
    }
    EXPECT_EQ(alarms, 0) << rim_m_s << " m/s, seed 5";
  }
}

}  // namespace
}  // namespace lsv::fusion
