// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/track_links.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/ground_travel.h"

namespace lsv {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TrackStep step(std::int64_t begin_ms, std::int64_t end_ms, double dx_m) {
  return {.begin = {begin_ms * kMs},
          .end = {end_ms * kMs},
          .dx_m = dx_m,
          .dy_m = 2.0 * dx_m,
          .xx_m2 = 1.0,
          .xy_m2 = 0.25,
          .yy_m2 = 0.5};
}

std::vector<Stamp> stamps(std::initializer_list<std::int64_t> times_ms) {
  std::vector<Stamp> out;
  for (const std::int64_t time_ms : times_ms) out.push_back({time_ms * kMs});
  return out;
}

BodyReference poses(std::initializer_list<std::int64_t> times_ms) {
  BodyReference out;
  for (const Stamp stamp : stamps(times_ms)) out.push_back({.stamp = stamp});
  return out;
}

TEST(TrackLinks, AStepIsSharedByTheLinksItLiesIn) {
  const SensorTrack track = {step(0, 10, 1.0), step(10, 20, 3.0), step(20, 30, 5.0)};
  const auto links = link_track(stamps({0, 15, 30}), track, 0.0);
  ASSERT_EQ(links.size(), 2U);
  EXPECT_TRUE(links[0].is_known && links[1].is_known);
  EXPECT_NEAR(links[0].moments_m[0][0], 1.0 + 1.5, 1e-12);
  EXPECT_NEAR(links[1].moments_m[0][1], 2.0 * (1.5 + 5.0), 1e-12);
  EXPECT_NEAR(links[0].xx_m2, 1.5, 1e-12);
  EXPECT_NEAR(links[1].xy_m2, 0.375, 1e-12);
  // 1.0 at a third of the time, 1.5 at five sixths.
  EXPECT_NEAR(links[0].moments_m[1][0], 1.0 / 3.0 + 1.5 * 5.0 / 6.0, 1e-12);
  EXPECT_NEAR(links[0].moments_m[2][0], 1.0 / 9.0 + 1.5 * 25.0 / 36.0, 1e-12);
}

TEST(TrackLinks, AnOffsetMovesTheTrack) {
  const SensorTrack track = {step(100, 110, 1.0), step(110, 120, 3.0)};
  const auto links = link_track(stamps({0, 10, 20}), track, -0.1);
  EXPECT_TRUE(links[0].is_known && links[1].is_known);
  EXPECT_NEAR(links[1].moments_m[0][0], 3.0, 1e-12);
  EXPECT_EQ(placed_poses(poses({0, 10, 20}), track, -0.1).size(), 3U);
  EXPECT_TRUE(placed_poses(poses({0, 10, 20}), track, 0.0).empty());
}

// What was travelled in a gap is not known, though the steps on both sides are.
TEST(TrackLinks, AGapIsNotBridged) {
  const SensorTrack track = {step(0, 10, 1.0), step(12, 30, 3.0)};
  const auto links = link_track(stamps({0, 8, 16, 24}), track, 0.0);
  EXPECT_TRUE(links[0].is_known);
  EXPECT_FALSE(links[1].is_known);
  EXPECT_TRUE(links[2].is_known);
  EXPECT_EQ(placed_poses(poses({0, 11, 24}), track, 0.0), (std::vector<std::size_t>{0, 2}));
}

// A shift over refused frames was measured as a whole; where the sensor was in between was not.
TEST(TrackLinks, NoPoseIsPlacedWithinRefusedFrames) {
  SensorTrack track = {step(0, 10, 1.0), step(10, 30, 3.0), step(30, 40, 1.0)};
  track[1].spans_refused = true;
  EXPECT_EQ(placed_poses(poses({0, 10, 20, 30, 40}), track, 0.0),
            (std::vector<std::size_t>{0, 1, 3, 4}));
  const auto links = link_track(stamps({0, 10, 30, 40}), track, 0.0);
  EXPECT_TRUE(links[1].is_known);
  EXPECT_NEAR(links[1].moments_m[0][0], 3.0, 1e-12);
}

TEST(TrackLinks, APauseOfTheReferenceIsAGap) {
  const SensorTrack track = {step(0, 1000, 1.0)};
  const auto links = link_track(stamps({0, 10, 20, 30, 500, 510, 520}), track, 0.0);
  EXPECT_TRUE(links[2].is_known);
  EXPECT_FALSE(links[3].is_known);
  EXPECT_TRUE(links[4].is_known);
  EXPECT_TRUE(link_track({}, track, 0.0).empty());
}

// Evenly along a quarter of a small circle: the series of ground_travel() against the chord.
TEST(GroundTravel, IsTheChordOfAnArc) {
  constexpr double kTurn_rad = 0.25;
  constexpr int kSteps = 200;
  SensorTrack track;
  for (int i = 0; i < kSteps; ++i) {
    track.push_back(
        {.begin = {i * kMs}, .end = {(i + 1) * kMs}, .dx_m = 1.0 / kSteps, .dy_m = 0.0});
  }
  const TrackLink link = link_track(stamps({0, kSteps}), track, 0.0)[0];
  const double chord_m = 2.0 / kTurn_rad * std::sin(0.5 * kTurn_rad);
  const double kSeries_m = std::pow(kTurn_rad, 4) / 24.0;
  const GroundTravel left = ground_travel(link, 0.0, kTurn_rad);
  EXPECT_NEAR(left.d_m.x(), chord_m * std::cos(0.5 * kTurn_rad), kSeries_m);
  EXPECT_NEAR(left.d_m.y(), chord_m * std::sin(0.5 * kTurn_rad), kSeries_m);
  EXPECT_GT(left.d_m.y(), 0.1);
  // Derivatives against differences.
  constexpr double kStep_rad = 1e-6;
  const auto to = ground_travel(link, 0.4, kTurn_rad + kStep_rad).d_m;
  const auto from = ground_travel(link, 0.4 + kStep_rad, kTurn_rad - kStep_rad).d_m;
  const GroundTravel here = ground_travel(link, 0.4, kTurn_rad);
  EXPECT_LT(((to - here.d_m) / kStep_rad - here.by_to).norm(), 1e-5);
  EXPECT_LT(((from - here.d_m) / kStep_rad - here.by_from).norm(), 1e-5);
}

}  // namespace
}  // namespace lsv
