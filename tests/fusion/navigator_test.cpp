// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/navigator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <variant>

namespace lsv {
namespace {

constexpr double kDt_s = 0.05;
constexpr double kSpeed_m_s = 0.055;
constexpr std::int64_t kDt_ns = 50'000'000;

FusionConfig rover() {
  FusionConfig out;
  out.wheels = WheelConfig{0.1, 0.8, 0.017, {}};
  out.lsv = {{"a", 0.2, 0.25, 0.0, 7e-4}, {"b", 0.35, -0.3, 0.0, 7e-4}};
  out.gyro = GyroConfig{1e-3, 1e-2};
  return out;
}

Navigator navigator(const FusionConfig& config) { return Navigator::create(config).value(); }

LsvSample lsv_sample(std::int64_t ns, double vx_m_s, double vy_m_s = 0.0) {
  return {.stamp = {ns}, .vx_m_s = vx_m_s, .vy_m_s = vy_m_s};
}

/// Straight ahead, everything fits.
void drive(Navigator& nav, int from, int to, double speed_m_s = kSpeed_m_s) {
  for (int k = from; k < to; ++k) {
    for (const std::size_t sensor : {0U, 1U}) nav.add(sensor, lsv_sample(k * kDt_ns, speed_m_s));
    nav.add(WheelSample{{k * kDt_ns}, speed_m_s / 0.1, speed_m_s / 0.1});
    nav.add(GyroSample{{k * kDt_ns}, 0.003});
  }
}

TEST(Navigator, KnowsNothingBeforeTheFirstSample) {
  const Navigator nav = navigator(rover());
  EXPECT_EQ(nav.state().status, NavStatus::not_started);
  EXPECT_TRUE(std::isnan(nav.state().x_m));
}

TEST(Navigator, DrivesStraight) {
  FusionConfig config = rover();
  config.start.yaw_rad = 0.7;
  Navigator nav = navigator(config);
  drive(nav, 0, 201);
  const NavState state = nav.state();
  EXPECT_EQ(state.status, NavStatus::ok);
  EXPECT_NEAR(state.x_m, 10.0 * kSpeed_m_s * std::cos(0.7), 1e-6);
  EXPECT_NEAR(state.y_m, 10.0 * kSpeed_m_s * std::sin(0.7), 1e-6);
  EXPECT_NEAR(state.yaw_rad, 0.7, 1e-5);
  EXPECT_NEAR(state.left.efficiency_ratio, 1.0, 1e-5);
  EXPECT_NEAR(state.gyro_bias_rad_s, 0.003, 1e-4);
  EXPECT_EQ(nav.counters().lsv_accepted, 402U);
}

// The pose is corrected to and fro; that is no way travelled.
TEST(Navigator, ThePathIsWhatTheSpeedSaysAndNotTheCorrectionsOfThePose) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 1.0);
  FusionConfig wheels_only = rover();
  wheels_only.lsv.clear();
  FusionConfig one_sensor = rover();
  one_sensor.lsv.pop_back();
  for (const FusionConfig& config : {rover(), wheels_only, one_sensor}) {
    Navigator nav = navigator(config);
    double poses_m = 0.0;
    NavState last;
    for (int k = 0; k <= 2000; ++k) {
      const Stamp stamp{k * kDt_ns};
      for (std::size_t i = 0; i < config.lsv.size(); ++i)
        nav.add(i, lsv_sample(stamp.ns, kSpeed_m_s + 7e-4 * noise(random), 7e-4 * noise(random)));
      nav.add(WheelSample{stamp, 0.55 + 0.017 * noise(random), 0.55 + 0.017 * noise(random)});
      const NavState now = nav.state();
      if (k > 0) poses_m += std::hypot(now.x_m - last.x_m, now.y_m - last.y_m);
      last = now;
    }
    std::printf("path %.4f m (true 5.5), corrections included %.4f m\n", last.path_m, poses_m);
    EXPECT_NEAR(last.path_m, 5.5, 0.02) << "seed 5";
    const NavState later = nav.state_at({last.stamp.ns + kNsPerS});
    EXPECT_NEAR(later.path_m, last.path_m + std::hypot(last.vx_m_s, last.vy_m_s), 1e-3);
  }
}

// Turns left about a point on the left; the sensors feel their lever arms.
TEST(Navigator, TurnsLeft) {
  FusionConfig config = rover();
  config.gyro.reset();
  config.motion.vy_sigma_m_s = 0.0;
  Navigator nav = navigator(config);
  const double wz_rad_s = 0.1;
  for (int k = 0; k <= 200; ++k) {
    for (std::size_t i = 0; i < 2; ++i) {
      nav.add(i, lsv_sample(k * kDt_ns, kSpeed_m_s - wz_rad_s * config.lsv[i].y_m,
                            wz_rad_s * config.lsv[i].x_m));
    }
    nav.add(WheelSample{
        {k * kDt_ns}, (kSpeed_m_s - 0.4 * wz_rad_s) / 0.1, (kSpeed_m_s + 0.4 * wz_rad_s) / 0.1});
  }
  const double radius_m = kSpeed_m_s / wz_rad_s;
  EXPECT_NEAR(nav.state().yaw_rad, 1.0, 1e-6);
  EXPECT_NEAR(nav.state().x_m, radius_m * std::sin(1.0), 1e-6);
  EXPECT_NEAR(nav.state().y_m, radius_m * (1.0 - std::cos(1.0)), 1e-6);
  EXPECT_NEAR(nav.state().left.efficiency_ratio, 1.0, 1e-6);
}

TEST(Navigator, OneWheelThatSlipsIsTheOneThatIsTold) {
  for (const bool is_left : {true, false}) {
    Navigator nav = navigator(rover());
    drive(nav, 0, 100);
    // 0.75 of the speed and a turn towards the wheel that slips.
    const double vx_m_s = 0.75 * kSpeed_m_s, wz_rad_s = (is_left ? 1.0 : -1.0) * 0.034375;
    for (int k = 100; k < 200; ++k) {
      for (std::size_t i = 0; i < 2; ++i) {
        const LsvConfig at = rover().lsv[i];
        nav.add(i, lsv_sample(k * kDt_ns, vx_m_s - wz_rad_s * at.y_m, wz_rad_s * at.x_m));
      }
      nav.add(WheelSample{{k * kDt_ns}, kSpeed_m_s / 0.1, kSpeed_m_s / 0.1});
    }
    const NavState state = nav.state();
    EXPECT_EQ(state.left.is_slipping, is_left);
    EXPECT_EQ(state.right.is_slipping, !is_left);
    EXPECT_NEAR(state.left.efficiency_ratio, is_left ? 0.5 : 1.0, 0.01);
    EXPECT_NEAR(state.right.efficiency_ratio, is_left ? 1.0 : 0.5, 0.01);
    EXPECT_TRUE(state.left.is_slip_known);
  }
}

// Noise of the readings must not pull the efficiency, on which nothing else says a word.
TEST(Navigator, WheelsAloneRollAsFarAsTheyTurn) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.017);
  FusionConfig config = rover();
  config.lsv.clear();
  Navigator nav = navigator(config);
  for (int k = 0; k <= 2000; ++k)
    nav.add(WheelSample{{k * kDt_ns}, 0.55 + noise(random), 0.55 + noise(random)});
  EXPECT_EQ(nav.state().status, NavStatus::ok);
  EXPECT_NEAR(nav.state().x_m, 5.5, 0.03) << "seed 3";
  // As far as slip is likely the way is not known.
  EXPECT_GT(std::sqrt(nav.state().cov[0][0]), 0.3);
}

TEST(Navigator, OpticsLostAreToldAtOnceAndWheelsCarryOn) {
  Navigator nav = navigator(rover());
  drive(nav, 0, 100);
  const double sigma_m = std::sqrt(nav.state().cov[0][0]);
  for (int k = 100; k < 200; ++k) nav.add(WheelSample{{k * kDt_ns}, 0.55, 0.55});
  EXPECT_EQ(nav.state_at({101 * kDt_ns}).status, NavStatus::optical_lost) << "newest is later";
  EXPECT_EQ(nav.state().status, NavStatus::optical_lost);
  EXPECT_FALSE(nav.state().left.is_slip_known);
  EXPECT_NEAR(nav.state().x_m, 199 * kDt_s * kSpeed_m_s, 1e-6);
  EXPECT_GT(std::sqrt(nav.state().cov[0][0]), 2.0 * sigma_m);
  drive(nav, 200, 202);
  EXPECT_EQ(nav.state().status, NavStatus::ok);
}

// What no longer comes must be told, of each sensor, and what the heading rests on from then on.
TEST(Navigator, ASensorThatGoesAwayIsTold) {
  for (const bool has_gyro : {false, true}) {
    for (const bool has_wheels : {false, true}) {
      FusionConfig config = rover();
      if (!has_gyro) config.gyro.reset();
      if (!has_wheels) config.wheels.reset();
      Navigator nav = navigator(config);
      EXPECT_EQ(nav.state().heading, HeadingSource::nothing);
      drive(nav, 0, 100);
      EXPECT_EQ(nav.state().heading, HeadingSource::optics);
      for (int k = 100; k < 200; ++k) {
        nav.add(0, lsv_sample(k * kDt_ns, kSpeed_m_s));
        nav.add(WheelSample{{k * kDt_ns}, 0.55, 0.55});
        nav.add(GyroSample{{k * kDt_ns}, 0.003});
        if (k > 102) continue;
        EXPECT_EQ(nav.state().heading == HeadingSource::optics, k < 102) << "within 100 ms";
      }
      EXPECT_EQ(nav.state().status, NavStatus::ok);
      EXPECT_EQ(nav.state().heading, has_gyro     ? HeadingSource::gyro
                                     : has_wheels ? HeadingSource::wheels
                                                  : HeadingSource::side_slip);
      const auto [one, two] = std::pair(nav.counters().lsv[0], nav.counters().lsv[1]);
      EXPECT_EQ(one.accepted, 200U);
      EXPECT_EQ(two.accepted, 100U);
      EXPECT_EQ(one.last_seen->ns, 199 * kDt_ns);
      EXPECT_EQ(two.last_seen->ns, 99 * kDt_ns);
      EXPECT_EQ(one.refused + two.refused, 0U);
      EXPECT_EQ(nav.state_at({199 * kDt_ns + kNsPerS}).heading, HeadingSource::nothing);
    }
  }
}

TEST(Navigator, ASensorThatIsAlwaysRefusedWasNeverSeen) {
  FusionConfig config = rover();
  config.lsv.push_back({"c", -0.3, 0.0, 0.0, 7e-4});
  Navigator nav = navigator(config);
  for (int k = 0; k < 100; ++k) {
    for (const std::size_t sensor : {0U, 1U, 2U})
      nav.add(sensor, lsv_sample(k * kDt_ns, sensor == 2 ? 1.0 : kSpeed_m_s));
  }
  EXPECT_EQ(nav.counters().lsv[2].accepted, 0U);
  EXPECT_EQ(nav.counters().lsv[2].refused, 100U);
  EXPECT_FALSE(nav.counters().lsv[2].last_seen.has_value());
  EXPECT_EQ(nav.counters().lsv[0].accepted, 100U);
}

TEST(Navigator, SensorsAtOnePlaceDoNotSeeTheHeading) {
  FusionConfig config = rover();
  config.wheels.reset();
  config.gyro.reset();
  config.lsv[1].x_m = config.lsv[0].x_m;
  config.lsv[1].y_m = config.lsv[0].y_m;
  Navigator nav = navigator(config);
  drive(nav, 0, 10);
  EXPECT_EQ(nav.state().heading, HeadingSource::side_slip);
}

TEST(Navigator, WithoutAnySourceItSaysSoWithin100Milliseconds) {
  FusionConfig config = rover();
  config.wheels.reset();
  Navigator nav = navigator(config);
  for (int k = 0; k < 50; ++k) nav.add(0, lsv_sample(k * kDt_ns, kSpeed_m_s));
  const Stamp last = nav.state().stamp;
  EXPECT_EQ(nav.state_at({last.ns + 90'000'000}).status, NavStatus::ok);
  EXPECT_EQ(nav.state_at({last.ns + 101'000'000}).status, NavStatus::no_motion_source);
  double sigma_m = 0.0;
  for (int s = 1; s < 100; ++s) {
    const double next_m = std::sqrt(nav.state_at({last.ns + s * kNsPerS}).cov[0][0]);
    EXPECT_GT(next_m, sigma_m);
    sigma_m = next_m;
  }
}

TEST(Navigator, AJumpOfVelocityIsNeverRefused) {
  Navigator nav = navigator(rover());
  drive(nav, 0, 100);
  drive(nav, 100, 200, 0.5 * kSpeed_m_s);
  const FusionCounters counters = nav.counters();
  EXPECT_EQ(counters.lsv_refused_by_innovation + counters.lsv_refused_by_parity, 0U);
  EXPECT_GE(counters.velocity_steps, 1U);
  EXPECT_NEAR(nav.state().vx_m_s, 0.5 * kSpeed_m_s, 1e-4);
}

TEST(Navigator, OneSensorAloneIsBelievedAfterAStreak) {
  FusionConfig config = rover();
  config.lsv.pop_back();
  config.wheels.reset();
  config.gyro.reset();
  Navigator nav = navigator(config);
  for (int k = 0; k < 100; ++k) nav.add(0, lsv_sample(k * kDt_ns, kSpeed_m_s));
  for (int k = 100; k < 110; ++k) nav.add(0, lsv_sample(k * kDt_ns, 5.0 * kSpeed_m_s));
  EXPECT_EQ(nav.counters().lsv_refused_by_innovation,
            static_cast<std::uint64_t>(config.max_rejected_in_a_row));
  EXPECT_EQ(nav.counters().lsv_streaks_ended, 1U);
  EXPECT_NEAR(nav.state().vx_m_s, 5.0 * kSpeed_m_s, 1e-3);
}

TEST(Navigator, StandstillHoldsThePlace) {
  FusionConfig config = rover();
  config.lsv.clear();
  Navigator nav = navigator(config);
  for (int k = 0; k < 200; ++k) {
    nav.add(StandstillSample{.stamp = {k * kDt_ns}});
    nav.add(GyroSample{{k * kDt_ns}, 0.007});
  }
  EXPECT_NEAR(nav.state().gyro_bias_rad_s, 0.007, 2e-4);
  EXPECT_NEAR(nav.state().yaw_rad, 0.0, 1e-3);
}

// --- samples that should not be

TEST(Navigator, RefusesWhatIsNotFiniteAndStaysAsItWas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  Navigator nav = navigator(rover());
  drive(nav, 0, 20);
  const NavState before = nav.state();
  const Stamp next{20 * kDt_ns};
  EXPECT_EQ(nav.add(0, {.stamp = next, .vx_m_s = nan, .vy_m_s = 0.0}), SampleStatus::invalid);
  EXPECT_EQ(nav.add(0, {.stamp = next, .vx_m_s = 0.0, .vy_m_s = inf}), SampleStatus::invalid);
  for (const double sigma_m_s : {0.0, -1.0, inf}) {
    EXPECT_EQ(nav.add(0, {.stamp = next, .vx_m_s = 0.0, .vy_m_s = 0.0, .sigma_vx_m_s = sigma_m_s}),
              SampleStatus::invalid);
  }
  for (const double interval_s : {-0.001, nan, inf}) {
    EXPECT_EQ(nav.add(0, {.stamp = next, .interval_s = interval_s, .vx_m_s = 0.0, .vy_m_s = 0.0}),
              SampleStatus::invalid);
  }
  EXPECT_EQ(nav.add(WheelSample{next, nan, 0.0}), SampleStatus::invalid);
  EXPECT_EQ(nav.add(GyroSample{next, inf}), SampleStatus::invalid);
  EXPECT_EQ(nav.add(StandstillSample{next, 0.0, 1.0}), SampleStatus::invalid);
  EXPECT_EQ(nav.add(2, lsv_sample(next.ns, 0.0)), SampleStatus::unknown_sensor);
  for (const std::int64_t ns :
       {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
    EXPECT_EQ(nav.add(GyroSample{{ns}, 0.0}), SampleStatus::invalid);
    LsvSample far = lsv_sample(ns, 0.0);
    far.interval_s = 0.1;
    EXPECT_EQ(nav.add(0, far), SampleStatus::invalid);
  }
  EXPECT_EQ(nav.state().stamp, before.stamp);
  EXPECT_EQ(nav.state().x_m, before.x_m);
  EXPECT_EQ(nav.counters().invalid, 16U);
}

TEST(Navigator, RefusesAnImpossibleRover) {
  FusionConfig config = rover();
  config.wheels->track_m = 0.0;
  EXPECT_FALSE(Navigator::create(config));
}

TEST(Navigator, WhatIsTooOldIsCountedAndLeftOut) {
  FusionConfig config = rover();
  config.late_epochs = 10;
  Navigator nav = navigator(config);
  drive(nav, 0, 100);
  const NavState before = nav.state();
  EXPECT_EQ(nav.add(0, lsv_sample(50 * kDt_ns + 1'000'000, 9.0)), SampleStatus::too_late);
  EXPECT_EQ(nav.add(0, lsv_sample(-kDt_ns, 9.0)), SampleStatus::too_late);
  EXPECT_EQ(nav.counters().too_late, 2U);
  EXPECT_EQ(nav.state().x_m, before.x_m);
}

// Half an interval of way and of turning is not lost, whichever sample comes first.
TEST(Navigator, TheStartIsWhereTheFirstIntervalBegins) {
  FusionConfig config = rover();
  config.gyro.reset();
  config.start = {.x_m = 1.0, .yaw_rad = 0.3};
  const double wz_rad_s = 0.1;
  for (const bool wheels_first : {false, true}) {
    Navigator nav = navigator(config);
    const WheelSample wheels{
        {20'000'000}, (kSpeed_m_s - 0.4 * wz_rad_s) / 0.1, (kSpeed_m_s + 0.4 * wz_rad_s) / 0.1};
    if (wheels_first) nav.add(wheels);
    for (std::int64_t k = 1; k <= 100; ++k) {
      for (std::size_t i = 0; i < 2; ++i) {
        LsvSample sample = lsv_sample(k * 100'000'000, kSpeed_m_s - wz_rad_s * config.lsv[i].y_m,
                                      wz_rad_s * config.lsv[i].x_m);
        sample.interval_s = 0.1;
        EXPECT_EQ(nav.add(i, sample), SampleStatus::taken);
      }
      if (k == 1 && !wheels_first) nav.add(wheels);
    }
    // The last sample counts for its middle; its end is one prediction away.
    const NavState end = nav.state_at({10 * kNsPerS});
    const double turn_rad = wz_rad_s * 10.0, radius_m = kSpeed_m_s / wz_rad_s;
    EXPECT_NEAR(end.yaw_rad, 0.3 + turn_rad, 1e-4);
    EXPECT_NEAR(end.x_m, 1.0 + radius_m * (std::sin(0.3 + turn_rad) - std::sin(0.3)), 1e-4);
    EXPECT_NEAR(end.y_m, radius_m * (std::cos(0.3) - std::cos(0.3 + turn_rad)), 1e-4);
    EXPECT_NEAR(end.path_m, 10.0 * kSpeed_m_s, 1e-4);
  }
}

TEST(Navigator, TheStartStaysWhenItCannotBeGoneBackTo) {
  FusionConfig config = rover();
  config.late_epochs = 10;
  Navigator nav = navigator(config);
  drive(nav, 0, 15);
  LsvSample sample = lsv_sample(15 * kDt_ns, kSpeed_m_s);
  sample.interval_s = 0.9;  // its middle can, its beginning not
  const double x_m = nav.state().x_m;
  EXPECT_EQ(nav.add(0, sample), SampleStatus::taken);
  EXPECT_NEAR(nav.state().x_m, x_m, 1e-6);
}

using AnySample = std::variant<LsvSample, WheelSample, GyroSample>;
struct Arrival {
  std::size_t sensor;
  AnySample sample;
};

// The law that makes live and replayed runs the same.
TEST(Navigator, TheOrderOfArrivalDoesNotMatter) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<Arrival> arrivals;
  for (int k = 1; k < 150; ++k) {
    const double speed_m_s = k < 80 ? kSpeed_m_s : 0.4 * kSpeed_m_s;  // with a jump in between
    for (std::size_t i = 0; i < 2; ++i) {
      const double wrong_m_s = random() % 20 == 0 ? 0.2 : 0.0;
      arrivals.push_back({i, lsv_sample(k * kDt_ns, speed_m_s + wrong_m_s + 7e-4 * noise(random),
                                        7e-4 * noise(random))});
    }
    arrivals.push_back({0, WheelSample{{k * kDt_ns + 13'000'000},
                                       0.55 + 0.017 * noise(random),
                                       0.55 + 0.017 * noise(random)}});
    arrivals.push_back({0, GyroSample{{k * kDt_ns + 13'000'000}, 1e-3 * noise(random)}});
  }
  const auto run = [&](const std::vector<Arrival>& in) {
    Navigator nav = navigator(rover());
    nav.add(GyroSample{{0}, 0.0});
    for (const Arrival& arrival : in) {
      SampleStatus status{};
      if (const auto* lsv = std::get_if<LsvSample>(&arrival.sample))
        status = nav.add(arrival.sensor, *lsv);
      if (const auto* wheels = std::get_if<WheelSample>(&arrival.sample)) status = nav.add(*wheels);
      if (const auto* gyro = std::get_if<GyroSample>(&arrival.sample)) status = nav.add(*gyro);
      EXPECT_EQ(status, SampleStatus::taken);
    }
    return nav;
  };
  const Navigator ordered = run(arrivals);
  EXPECT_EQ(ordered.counters().late, 0U);
  for (std::size_t i = 0; i + 40 <= arrivals.size(); i += 40)
    std::shuffle(arrivals.begin() + static_cast<std::ptrdiff_t>(i),
                 arrivals.begin() + static_cast<std::ptrdiff_t>(i) + 40, random);
  const Navigator shuffled = run(arrivals);
  EXPECT_GT(shuffled.counters().late, 100U);
  EXPECT_EQ(ordered.state().x_m, shuffled.state().x_m);
  EXPECT_EQ(ordered.state().yaw_rad, shuffled.state().yaw_rad);
  EXPECT_EQ(ordered.state().cov, shuffled.state().cov);
  EXPECT_EQ(ordered.counters().lsv_accepted, shuffled.counters().lsv_accepted);
  EXPECT_EQ(ordered.counters().lsv_refused_by_parity, shuffled.counters().lsv_refused_by_parity);
  EXPECT_GT(ordered.counters().lsv_refused_by_parity, 5U);
}

// A velocity is that of the middle of its interval.
TEST(Navigator, AMeanVelocityCountsForTheMiddleOfItsInterval) {
  Navigator nav = navigator(rover());
  nav.add(GyroSample{{0}, 0.0});
  LsvSample sample = lsv_sample(100'000'000, kSpeed_m_s);
  sample.interval_s = 0.1;
  nav.add(0, sample);
  EXPECT_EQ(nav.state().stamp.ns, 50'000'000);
}

}  // namespace
}  // namespace lsv
