// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/rover_config.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace lsv {
namespace {

FusionConfig good() {
  FusionConfig out;
  out.wheels = WheelConfig{0.1, 0.8, 0.017, 1024.0};
  out.lsv = {{"a", 0.2, 0.25, 0.0, 7e-4}, {"b", 0.35, -0.3, 0.0, 7e-4}};
  out.gyro = GyroConfig{1e-3, 1e-3};
  return out;
}

TEST(FusionConfig, EveryFigureIsChecked) {
  ASSERT_TRUE(validate(good()));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::function<double&(FusionConfig&)> positive[] = {
      [](FusionConfig& c) -> double& { return c.wheels->radius_m; },
      [](FusionConfig& c) -> double& { return c.wheels->track_m; },
      [](FusionConfig& c) -> double& { return c.wheels->noise_rad_s; },
      [](FusionConfig& c) -> double& { return *c.wheels->ticks_per_turn; },
      [](FusionConfig& c) -> double& { return c.lsv[1].noise_m_s; },
      [](FusionConfig& c) -> double& { return c.gyro->noise_rad_s; },
      [](FusionConfig& c) -> double& { return c.motion.vx_walk_m_s; },
      [](FusionConfig& c) -> double& { return c.motion.wz_walk_rad_s; },
      [](FusionConfig& c) -> double& { return c.motion.vy_time_s; },
      [](FusionConfig& c) -> double& { return c.motion.efficiency_time_s; },
      [](FusionConfig& c) -> double& { return c.slip.alarm_ratio; },
      [](FusionConfig& c) -> double& { return c.gate_probability; },
      [](FusionConfig& c) -> double& { return c.optical_timeout_s; }};
  for (const auto& field : positive) {
    for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
      FusionConfig config = good();
      field(config) = bad;
      EXPECT_FALSE(validate(config)) << &field - positive << " " << bad;
    }
  }
  for (const double bad : {-0.001, 0.11, nan}) {
    FusionConfig config = good();
    config.lsv[1].sigma_scale_ratio = bad;
    EXPECT_FALSE(validate(config)) << bad;
  }
  FusionConfig config = good();
  config.lsv[0].x_m = nan;
  ASSERT_FALSE(validate(config));
  EXPECT_NE(validate(config).error().message.find("lsv[0].x_m"), std::string::npos);
}

TEST(FusionConfig, NothingThatTellsSpeedIsNoRover) {
  FusionConfig config = good();
  config.wheels.reset();
  config.lsv.clear();
  EXPECT_FALSE(validate(config));
  config = good();
  config.lsv.resize(kMaxLsvSensors + 1, config.lsv[0]);
  EXPECT_FALSE(validate(config));
}

TEST(MountingRank, TwoSensorsApartTellAllThreeSpeeds) {
  FusionConfig config = good();
  EXPECT_EQ(mounting_rank(config.lsv).rank, 3);
  EXPECT_NEAR(mounting_rank(config.lsv).spread_m, std::hypot(0.15, 0.55), 1e-12);
  EXPECT_TRUE(mounting_warnings(config).empty());
  config.lsv[1].x_m = config.lsv[0].x_m;
  config.lsv[1].y_m = config.lsv[0].y_m;
  EXPECT_EQ(mounting_rank(config.lsv).rank, 2);
  EXPECT_EQ(mounting_warnings(config).size(), 1U);
  config.lsv.pop_back();
  ASSERT_EQ(mounting_warnings(config).size(), 1U);
  EXPECT_NE(mounting_warnings(config)[0].find("side slip"), std::string::npos);
}

}  // namespace
}  // namespace lsv
