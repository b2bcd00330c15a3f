// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/look_planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "sim/speckle.h"

namespace lsv {
namespace {

constexpr FrameFormat kFormat{.width_px = 64, .height_px = 48};
constexpr double kApart_px = 5.0;

TEST(LookPlanner, APlaceCountsOnce) {
  LookPlanner planner(kFormat);
  EXPECT_TRUE(planner.is_due(0.0, 0.0, kApart_px));
  EXPECT_FALSE(planner.is_due(0.0, 0.0, kApart_px));
  EXPECT_FALSE(planner.is_due(3.0, 3.0, kApart_px));
  EXPECT_TRUE(planner.is_due(4.0, 4.0, kApart_px));
  EXPECT_TRUE(planner.is_due(-6.0, 0.0, kApart_px));
  EXPECT_FALSE(planner.is_due(1.0, -1.0, kApart_px));
  EXPECT_EQ(planner.looks(), 3U);
}

TEST(LookPlanner, LaterLooksAreSpread) {
  LookPlanner planner(kFormat);
  int due = 0;
  for (int k = 0; k < 64 + 16 * 10; ++k) due += planner.is_due(10.0 * k, 0.0, kApart_px) ? 1 : 0;
  EXPECT_EQ(due, 64 + 10);
}

/// Looks at a drive of which the places say nothing.
int looks_in(const std::function<double(int)>& x_px, int frames) {
  sim::SpeckleCamera camera =
      sim::SpeckleCamera::create({.width_px = 64, .height_px = 48, .seed = 3}).value();
  LookPlanner planner(kFormat);
  Frame frame;
  int due = 0;
  for (int k = 0; k < frames; ++k) {
    EXPECT_TRUE(camera.render(k, {.x_px = x_px(k)}, frame));
    due += planner.is_due_by_change(frame.view()) ? 1 : 0;
  }
  return due;
}

// Speckle of 4 px: over 80 px there are at most 20 that have nothing to do with each other.
TEST(LookPlanner, WhatChangesCountsOnceItHasChangedAltogether) {
  const int fast = looks_in([](int k) { return 10.0 * k; }, 40);
  const int slow = looks_in([](int k) { return 0.5 * k; }, 160);
  std::printf("looks: %d of 40 frames 10 px apart, %d of 160 frames 0.5 px apart\n", fast, slow);
  EXPECT_GE(fast, 20);
  EXPECT_LE(slow, 30);
  EXPECT_GE(slow, 5);
}

// However long it rocks, there is no more ground than these few places.
TEST(LookPlanner, GroundThatComesBackIsNoLook) {
  const auto rock = [](double amplitude_px) {
    return looks_in([=](int k) { return amplitude_px * std::sin(0.13 * k); }, 600);
  };
  const int near = rock(3.0);
  const int wide = rock(9.0);
  std::printf("looks: %d while rocking by 3 px, %d by 9 px\n", near, wide);
  EXPECT_LE(near, 5);
  EXPECT_LE(wide, 10);
}

// Creeping is no jump: a frame is not new because the one before it is the only one known.
TEST(LookPlanner, CreepingTakesItsTime) {
  const int looks = looks_in([](int k) { return 0.01 * k; }, 400);
  std::printf("looks: %d while creeping over 4 px\n", looks);
  EXPECT_LE(looks, 6);
}

TEST(LookPlanner, TheSameFrameAgainIsNoLook) {
  LookPlanner planner(kFormat);
  const Frame frame(kFormat);
  EXPECT_TRUE(planner.is_due_by_change(frame.view()));
  EXPECT_FALSE(planner.is_due_by_change(frame.view()));
}

}  // namespace
}  // namespace lsv
