// SPDX-License-Identifier: BSD-3-Clause
#include "tools/camera_simulator/exposures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace lsv::cli {
namespace {

constexpr int kFrames = 6;
constexpr std::int64_t kJitter_ns = 400'000;
constexpr double kPeriod_ns = 1e6;
constexpr double kSpeed_px = 2.0;

sim::SpeckleConfig small_camera() {
  sim::SpeckleConfig camera;
  camera.width_px = 16;
  camera.height_px = 8;
  camera.frame_rate_hz = 1e9 / kPeriod_ns;
  return camera;
}

Exposures exposures(std::int64_t jitter_ns) {
  return Exposures::render(small_camera(), sim::constant_velocity(kSpeed_px, 0.0), kFrames,
                           jitter_ns)
      .value();
}

TEST(Exposures, WithoutJitterTheyLieOnTheGrid) {
  const Exposures out = exposures(0);
  const double there_and_back_px[] = {0, 2, 4, 6, 8, 10, 8, 6, 4, 2, 0, 2};
  for (int k = 0; k < 12; ++k) {
    EXPECT_EQ(out.delay_ns(k), 0) << k;
    EXPECT_EQ(out.position(k).dx_px, there_and_back_px[k]) << k;
  }
}

TEST(Exposures, ThePatternIsWhereItIsWhenTheExposureIs) {
  const Exposures out = exposures(kJitter_ns);
  const double turn = kFrames - 1;
  std::set<std::int64_t> delays_ns;
  for (int k = 0; k <= 2 * (kFrames - 1); ++k) {
    const std::int64_t delay_ns = out.delay_ns(k);
    EXPECT_GE(delay_ns, 0) << k;
    EXPECT_LE(delay_ns, kJitter_ns) << k;
    delays_ns.insert(delay_ns);
    // Time since the start of the motion, in frames; the motion turns at `turn`.
    const double time = k + (static_cast<double>(delay_ns) - kJitter_ns / 2.0) / kPeriod_ns;
    EXPECT_NEAR(out.position(k).dx_px, kSpeed_px * (turn - std::abs(turn - time)), 1e-5) << k;
  }
  EXPECT_GT(delays_ns.size(), 4U);
}

}  // namespace
}  // namespace lsv::cli
