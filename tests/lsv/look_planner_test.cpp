// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/look_planner.h"

#include <gtest/gtest.h>

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
int looks_in(double step_px, int frames) {
  sim::SpeckleCamera camera =
      sim::SpeckleCamera::create({.width_px = 64, .height_px = 48, .seed = 3}).value();
  LookPlanner planner(kFormat);
  Frame frame;
  int due = 0;
  for (int k = 0; k < frames; ++k) {
    EXPECT_TRUE(camera.render(k, {.x_px = step_px * k}, frame));
    due += planner.is_due_by_change(frame.view()) ? 1 : 0;
  }
  return due;
}

// Speckle of 4 px: over 80 px there are at most 20 that have nothing to do with each other.
TEST(LookPlanner, WhatChangesCountsOnceItHasChangedAltogether) {
  const int fast = looks_in(10.0, 40);
  const int slow = looks_in(0.5, 160);
  std::printf("looks: %d of 40 frames 10 px apart, %d of 160 frames 0.5 px apart\n", fast, slow);
  EXPECT_GE(fast, 20);
  EXPECT_LE(slow, 30);
  EXPECT_GE(slow, 5);
}

TEST(LookPlanner, TheSameFrameAgainIsNoLook) {
  LookPlanner planner(kFormat);
  const Frame frame(kFormat);
  EXPECT_TRUE(planner.is_due_by_change(frame.view()));
  EXPECT_FALSE(planner.is_due_by_change(frame.view()));
}

}  // namespace
}  // namespace lsv
