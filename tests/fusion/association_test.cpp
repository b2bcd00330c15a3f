// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/association.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "tests/fusion/trajectories.h"

namespace lsv {
namespace {

/// x of each pose says which it is.
Trajectory at_times(const std::vector<double>& times_s) {
  std::vector<TrajectoryPose> poses;
  for (const double time_s : times_s)
    poses.push_back(test::planar_pose(time_s, static_cast<double>(poses.size()), 0.0, 0.0));
  return test::planar(std::move(poses));
}

using Indices = std::vector<std::pair<int, int>>;

Indices indices_of(const PosePairs& pairs) {
  Indices out;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    out.emplace_back(static_cast<int>(pairs.estimate[i].x_m), static_cast<int>(pairs.truth[i].x_m));
  return out;
}

Indices matched(const std::vector<double>& estimate_s, const std::vector<double>& truth_s,
                const AssociationOptions& options) {
  return indices_of(associate(at_times(estimate_s), at_times(truth_s), options).value());
}

std::string refusal(const Trajectory& estimate, const Trajectory& truth,
                    const AssociationOptions& options = {}) {
  const Result<PosePairs> pairs = associate(estimate, truth, options);
  return pairs ? "" : pairs.error().message;
}

TEST(Association, NearestWithinTheTolerance) {
  const AssociationOptions options{.max_dt_s = 0.1};
  EXPECT_EQ(matched({0, 1, 2}, {0.05, 0.95, 2.2}, options), (Indices{{0, 0}, {1, 1}}));
  EXPECT_EQ(matched({0, 1}, {0.1, 1.100000001}, options), (Indices{{0, 0}}));  // to the ns
}

TEST(Association, NoPoseIsUsedTwice) {
  const AssociationOptions options{.max_dt_s = 1.0};
  EXPECT_EQ(matched({0, 0.4, 0.5}, {0.42}, options), (Indices{{1, 0}}));
  EXPECT_EQ(matched({0.42}, {0, 0.4, 0.5}, options), (Indices{{0, 1}}));
  EXPECT_EQ(matched({1}, {0, 2}, options), (Indices{{0, 0}}));  // equally near: the earlier
}

// A velocity counts for the middle of its interval: the pose made of it is half a period from the
// stamps it came with, on both sides. Neither direction of the search may break such ties its own
// way, nor the rounding of one of both to ns.
TEST(Association, StampsHalfAPeriodApartAllFindAPartner) {
  for (const double period_s : {0.001, 1.0 / 30.0, 0.1}) {
    for (const double half : {-0.5, 0.5}) {
      for (const double rounding_s : {0.0, 1e-9, -1e-9}) {
        SCOPED_TRACE(std::to_string(period_s) + " s, " + std::to_string(half));
        std::vector<double> estimate, truth;
        for (int i = 1; i <= 200; ++i) {
          truth.push_back(period_s * i);
          estimate.push_back(period_s * (i + half) + (i % 3 == 0 ? rounding_s : 0.0));
        }
        EXPECT_GE(matched(estimate, truth, {.max_dt_s = period_s}).size(), 199U);
        EXPECT_GE(matched(truth, estimate, {.max_dt_s = period_s}).size(), 199U);
      }
    }
  }
}

// A few poses that happen to meet say nothing of the rest.
TEST(Association, TooFewPairsAreRefused) {
  std::vector<double> estimate, truth;
  for (int i = 0; i < 200; ++i) {
    truth.push_back(i);
    estimate.push_back(i < 15 ? i : i + 0.4);
  }
  const std::string refused = refusal(at_times(estimate), at_times(truth));
  EXPECT_NE(refused.find("only 15 of 199 poses have a partner within 0.010000 s"),
            std::string::npos)
      << refused;
  EXPECT_EQ(refusal(at_times(estimate), at_times(truth), {.max_dt_s = 0.5}), "");
  // An estimate that ends early has partners for all of its time.
  truth.resize(200);
  estimate.resize(15);
  EXPECT_EQ(refusal(at_times(estimate), at_times(truth)), "");
}

// Epoch stamps against a clock that began at zero.
TEST(Association, TheOffsetIsAddedToTheEstimate) {
  const AssociationOptions options{.max_dt_s = 0.01, .offset_s = 1.7e9 - 5.0};
  const Result<PosePairs> pairs =
      associate(at_times({5.0, 6.0}), at_times({1.7e9, 1.7e9 + 1.005}), options);
  ASSERT_TRUE(pairs.ok());
  EXPECT_EQ(indices_of(pairs.value()), (Indices{{0, 0}, {1, 1}}));
  EXPECT_EQ(pairs.value().estimate[0].stamp.ns, 1'700'000'000'000'000'000);
  EXPECT_NEAR(pairs.value().max_dt_s, 0.005, 1e-6);
  EXPECT_NEAR(pairs.value().mean_dt_s, 0.0025, 1e-6);
}

TEST(Association, AgreesWithTheSearchOverAllPairs) {
  constexpr std::uint32_t kSeed = 64;
  std::mt19937 random(kSeed);
  for (int run = 0; run < 50; ++run) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", run " + std::to_string(run));
    std::vector<double> times[2];
    for (std::vector<double>& t : times) {
      double time_s = 0.0;
      for (int i = 0; i < 40; ++i)
        t.push_back(time_s += 0.001 * static_cast<double>(1 + random() % 60));
    }
    Indices expected;
    const auto ms = [](double time_s) { return std::lround(1000.0 * time_s); };
    // Of two as near, the earlier of the truth and the later of the estimate.
    const auto nearest = [&](const std::vector<double>& in, double time_s, bool is_later) {
      int best = 0;
      for (int i = 1; i < 40; ++i) {
        const auto far = [&](int k) {
          return std::abs(ms(in[static_cast<std::size_t>(k)]) - ms(time_s));
        };
        if (far(i) < far(best) || (is_later && far(i) == far(best))) best = i;
      }
      return best;
    };
    for (int i = 0; i < 40; ++i) {
      const double time_s = times[0][static_cast<std::size_t>(i)];
      const int j = nearest(times[1], time_s, false);
      const double other_s = times[1][static_cast<std::size_t>(j)];
      if (std::abs(ms(other_s) - ms(time_s)) <= 12 && nearest(times[0], other_s, true) == i)
        expected.emplace_back(i, j);
    }
    // Half a nanosecond and more of room for stamps that are sums of doubles.
    EXPECT_EQ(matched(times[0], times[1], {.max_dt_s = 0.0121}), expected);
  }
}

TEST(Association, WhatDoesNotBelongTogetherIsSaid) {
  const Trajectory early = at_times({0, 1, 2}), late = at_times({100, 101});
  EXPECT_NE(refusal(early, late)
                .find("do not overlap: the estimate is from 0 to 2 s, the truth "
                      "from 100 to 101 s"),
            std::string::npos)
      << refusal(early, late);
  EXPECT_NE(refusal(late, early).find("do not overlap"), std::string::npos);
  EXPECT_EQ(refusal(early, late, {.offset_s = 100.0}), "");
  const std::string apart = refusal(early, at_times({0.25, 1.25}));
  EXPECT_NE(apart.find("the nearest differ by 0.25 s"), std::string::npos) << apart;
  EXPECT_NE(refusal(at_times({0, 2, 1}), early).find("the estimate do not increase after 2 s"),
            std::string::npos);
  EXPECT_NE(refusal(early, at_times({0, 0})).find("the truth do not increase after 0 s"),
            std::string::npos);
  EXPECT_NE(refusal(test::planar({}), early).find("holds no pose"), std::string::npos);
  EXPECT_NE(refusal(early, early, {.max_dt_s = -1.0}).find("max_dt_s"), std::string::npos);
  EXPECT_NE(refusal(early, early, {.max_dt_s = NAN}).find("max_dt_s"), std::string::npos);
  EXPECT_NE(refusal(early, early, {.offset_s = 1e300}).find("offset_s"), std::string::npos);
  EXPECT_NE(refusal(at_times({3.9e9}), early, {.offset_s = 3.9e9}).find("beyond 126 years"),
            std::string::npos);
}

TEST(Association, WithoutTimeByOrder) {
  Trajectory rows = at_times({0, 1, 2});
  rows.has_time = false;
  const Trajectory timed = at_times({5, 6, 7});
  const PosePairs pairs = associate(timed, rows, {}).value();
  EXPECT_EQ(indices_of(pairs), (Indices{{0, 0}, {1, 1}, {2, 2}}));
  EXPECT_TRUE(pairs.has_time);
  EXPECT_EQ(pairs.truth[1].stamp.ns, 6'000'000'000);
  EXPECT_FALSE(associate(rows, rows, {}).value().has_time);
  EXPECT_NE(refusal(rows, at_times({1})).find("3 of the estimate and 1 of the truth"),
            std::string::npos);
}

TEST(Association, AgainstAPlaneOnlyThePlaneCounts) {
  Trajectory space = at_times({0});
  space.is_planar = false;
  space.poses[0].z_m = 5.0;
  // Heading 90 degrees, then rolled.
  space.poses[0].rotation = {.x = 0.5, .y = 0.5, .z = 0.5, .w = 0.5};
  const double heading = heading_rad(space.poses[0].rotation);
  const PosePairs pairs = associate(at_times({0}), space, {}).value();
  EXPECT_TRUE(pairs.is_planar);
  EXPECT_EQ(pairs.truth[0].z_m, 0.0);
  EXPECT_EQ(pairs.truth[0].rotation.x, 0.0);
  EXPECT_NEAR(heading_rad(pairs.truth[0].rotation), heading, 1e-15);
  EXPECT_EQ(associate(space, space, {}).value().truth[0].z_m, 5.0);
  Trajectory without = at_times({0});
  without.has_rotation = false;
  EXPECT_FALSE(associate(without, space, {}).value().has_rotation);
  EXPECT_TRUE(std::isnan(associate(without, space, {}).value().truth[0].rotation.w));
}

}  // namespace
}  // namespace lsv
