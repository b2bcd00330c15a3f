// SPDX-License-Identifier: BSD-3-Clause
// The hot path allocates nothing after construction.
#include <gtest/gtest.h>

#include "lsv/odometer.h"
#include "sim/speckle.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/calibration.h"

namespace lsv {
namespace {

TEST(AllocationCounter, SeesAnAllocation) {
  test::count_allocations(true);
  int* const volatile p = new int(3);
  test::count_allocations(false);
  delete p;
  EXPECT_EQ(test::allocations(), 1);
}

class AllocationIn : public testing::TestWithParam<Engine> {};

TEST_P(AllocationIn, PushAllocatesNothing) {
  TrackConfig config = test::bridget_config();
  config.correlation.engine = GetParam();
  for (const int bit_depth : {8, 12}) {
    const sim::SpeckleConfig camera_config{.width_px = 72, .height_px = 64, .bit_depth = bit_depth};
    sim::SpeckleCamera camera = sim::SpeckleCamera::create(camera_config).value();
    const FrameFormat format = sim::frame_format(camera_config);
    Odometer odometer = Odometer::create(config, format).value();
    std::vector<Frame> frames(6);
    for (int i = 0; i < 6; ++i) {
      Frame& frame = frames[static_cast<std::size_t>(i)];
      ASSERT_TRUE(camera.render(i, {.x_px = 2.3 * i}, frame));
    }
    // A refused frame takes its own path.
    for (int y = 0; y < format.height_px; ++y) {
      if (bit_depth == 8)
        std::fill_n(frames[3].row8(y), format.width_px, std::uint8_t{0});
      else
        std::fill_n(frames[3].row16(y), format.width_px, std::uint16_t{0});
    }
    long allocations = 0;
    int reports = 0;
    for (const Frame& frame : frames) {
      test::count_allocations(true);
      const Result<StepReport> report = odometer.push(frame.view());
      test::count_allocations(false);
      allocations += test::allocations();
      reports += report.ok() ? 1 : 0;
    }
    EXPECT_EQ(reports, 6);
    EXPECT_EQ(allocations, 0) << word(GetParam()) << ", " << bit_depth << " bit";
  }
}

TEST(Allocation, NoPresetAllocates) {
  for (const Preset preset : {Preset::precise, Preset::fast, Preset::classic}) {
    TrackConfig config = test::bridget_config();
    config.preset = preset;
    sim::SpeckleCamera camera =
        sim::SpeckleCamera::create({.width_px = 72, .height_px = 64}).value();
    Odometer odometer = Odometer::create(config, sim::frame_format(camera.config())).value();
    std::vector<Frame> frames(40);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      // New keyframes on the way, and a jump to other ground.
      const double x_px = 2.3 * static_cast<double>(i) + (i > 30 ? 400.0 : 0.0);
      ASSERT_TRUE(camera.render(static_cast<std::int64_t>(i), {.x_px = x_px}, frames[i]));
    }
    long allocations = 0;
    int accepted = 0;
    for (const Frame& frame : frames) {
      test::count_allocations(true);
      const Result<StepReport> report = odometer.push(frame.view());
      test::count_allocations(false);
      allocations += test::allocations();
      if (report && report.value().shift.status == ShiftStatus::ok) ++accepted;
    }
    EXPECT_EQ(accepted, 38) << word(preset);
    EXPECT_EQ(allocations, 0) << word(preset);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryEngine, AllocationIn,
                         testing::Values(Engine::zncc, Engine::cross, Engine::phase,
                                         Engine::direct),
                         [](const auto& engine) { return std::string(word(engine.param)); });

}  // namespace
}  // namespace lsv
