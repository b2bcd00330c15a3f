// SPDX-License-Identifier: BSD-3-Clause
// The pipeline as its users meet it: frames of known motion in, reports out.
#include "lsv/odometer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sim/speckle.h"
#include "tests/support/calibration.h"

namespace lsv {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000;

Frame simulated(sim::SpeckleCamera& camera, std::int64_t index, double x_px, double y_px) {
  Frame out;
  EXPECT_TRUE(camera.render(index, {.x_px = x_px, .y_px = y_px}, out));
  out.stamp = {index * kPeriod_ns};
  return out;
}

Frame constant(const FrameFormat& format, std::int64_t index, std::uint8_t counts) {
  Frame out(format);
  for (int y = 0; y < format.height_px; ++y) std::fill_n(out.row8(y), format.width_px, counts);
  out.index = index;
  out.stamp = {index * kPeriod_ns};
  return out;
}

class OdometerTest : public testing::Test {
 protected:
  OdometerTest()
      : camera_(sim::SpeckleCamera::create({.width_px = 96, .height_px = 80, .seed = 4}).value()),
        format_(sim::frame_format(camera_.config())),
        odometer_(Odometer::create(test::bridget_config(), format_).value()) {}

  StepReport push(const Frame& frame) {
    const Result<StepReport> report = odometer_.push(frame.view());
    EXPECT_TRUE(report) << report.error().message;
    return report.value();
  }
  StepReport push_at(std::int64_t index, double x_px, double y_px) {
    return push(simulated(camera_, index, x_px, y_px));
  }

  sim::SpeckleCamera camera_;
  FrameFormat format_;
  Odometer odometer_;
};

TEST_F(OdometerTest, TheFirstFrameHasNoShift) {
  const StepReport first = push_at(0, 0.0, 0.0);
  EXPECT_EQ(first.shift.status, ShiftStatus::first_frame);
  EXPECT_TRUE(std::isnan(first.shift.dx_px));
  EXPECT_TRUE(std::isnan(first.velocity.vx_m_s));
  EXPECT_EQ(first.position.x_m, 0.0);
}

TEST_F(OdometerTest, ShiftVelocityAndPositionFollowThePattern) {
  push_at(0, 0.0, 0.0);
  const StepReport report = push_at(1, 4.25, -2.5);
  ASSERT_EQ(report.shift.status, ShiftStatus::ok);
  EXPECT_NEAR(report.shift.dx_px, 4.25, 0.02);
  EXPECT_NEAR(report.shift.dy_px, -2.5, 0.02);
  EXPECT_EQ(report.dt_ns, kPeriod_ns);
  EXPECT_DOUBLE_EQ(report.velocity.vx_m_s, report.shift.dx_px * 14e-6 / 1.985 / 1e-3);
  EXPECT_DOUBLE_EQ(report.velocity.vy_m_s, report.shift.dy_px * 14e-6 / 2.0 / 1e-3);
  EXPECT_GT(report.velocity.sigma_vx_m_s, 0.0);
  EXPECT_DOUBLE_EQ(report.position.x_m, report.shift.dx_px * 14e-6 / 1.985);
}

TEST_F(OdometerTest, ThereAndBackReturnsToTheStart) {
  double x_px = 0.0;
  for (int i = 0; i <= 12; ++i) {
    x_px += i <= 6 ? 1.3 : -1.3;
    push_at(i, x_px, 0.7 * x_px);
  }
  const StepReport last = push_at(13, 1.3, 0.91);
  EXPECT_NEAR(last.position.x_m, 0.0, 4.0 * last.position.sigma_x_m + 1e-8);
  EXPECT_NEAR(last.position.y_m, 0.0, 4.0 * last.position.sigma_y_m + 1e-8);
}

TEST_F(OdometerTest, AMissingFrameMeansTheRealTime) {
  push_at(0, 0.0, 0.0);
  const StepReport one = push_at(1, 2.0, 0.0);
  const StepReport three = push_at(4, 8.0, 0.0);  // frames 2 and 3 are missing
  EXPECT_EQ(three.dt_ns, 3 * kPeriod_ns);
  EXPECT_NEAR(three.velocity.vx_m_s, one.velocity.vx_m_s, 2e-4);
}

TEST_F(OdometerTest, ADarkFrameHoldsThePositionAndInventsNothing) {
  push_at(0, 0.0, 0.0);
  const StepReport before = push_at(1, 3.0, 1.0);
  for (int i = 2; i <= 4; ++i) {
    const StepReport dark = push(constant(format_, i, 3));
    EXPECT_EQ(dark.shift.status, ShiftStatus::dark);
    EXPECT_TRUE(std::isnan(dark.shift.dx_px));
    EXPECT_TRUE(std::isnan(dark.velocity.vx_m_s));
    EXPECT_EQ(dark.position.x_m, before.position.x_m);
  }
  // The ground of the last accepted frame is still in view: the gap is bridged, not guessed.
  const StepReport after = push_at(5, 9.0, 1.0);
  ASSERT_EQ(after.shift.status, ShiftStatus::ok);
  EXPECT_EQ(after.search, Search::full_range);
  EXPECT_EQ(after.dt_ns, 4 * kPeriod_ns);
  EXPECT_EQ(after.segment, 0);
  EXPECT_NEAR(after.shift.dx_px, 6.0, 0.005);
  EXPECT_NEAR(after.position.x_m - before.position.x_m, 6.0 * 14e-6 / 1.985, 4e-8);
}

// While the laser was off the vehicle went further than the frame is wide.
TEST_F(OdometerTest, GroundThatIsGoneBeginsASegmentAndInventsNoDistance) {
  push_at(0, 0.0, 0.0);
  const StepReport before = push_at(1, 3.0, 1.0);
  push(constant(format_, 2, 3));
  const StepReport lost = push_at(3, 500.0, 80.0);
  EXPECT_NE(lost.shift.status, ShiftStatus::ok);
  EXPECT_EQ(lost.segment, 0);
  const StepReport found = push_at(4, 502.5, 80.0);
  ASSERT_EQ(found.shift.status, ShiftStatus::ok);
  EXPECT_EQ(found.segment, 1);
  EXPECT_EQ(found.dt_ns, kPeriod_ns);
  EXPECT_NEAR(found.shift.dx_px, 2.5, 0.005);
  EXPECT_NEAR(found.position.x_m - before.position.x_m, 2.5 * 14e-6 / 1.985, 4e-8);
}

TEST_F(OdometerTest, OneFrameOfOtherGroundIsBridged) {
  push_at(0, 0.0, 0.0);
  push_at(1, 1.0, 0.0);
  EXPECT_NE(push_at(2, 900.0, 0.0).shift.status, ShiftStatus::ok);
  const StepReport after = push_at(3, 3.0, 0.0);
  ASSERT_EQ(after.shift.status, ShiftStatus::ok);
  EXPECT_EQ(after.segment, 0);
  EXPECT_NEAR(after.shift.dx_px, 2.0, 0.005);
  EXPECT_NEAR(after.position.x_m, 3.0 * 14e-6 / 1.985, 6e-8);
}

TEST_F(OdometerTest, AStopAndAStartAreFollowed) {
  double x_px = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double step_px = i < 20 ? 4.0 : i < 40 ? 0.0 : -6.5;
    x_px += i == 0 ? 0.0 : step_px;
    const StepReport report = push_at(i, x_px, -0.4 * x_px);
    if (i == 0) continue;
    ASSERT_EQ(report.shift.status, ShiftStatus::ok) << i;
    EXPECT_NEAR(report.shift.dx_px, step_px, 0.005) << i;
    EXPECT_NEAR(report.position.x_m, x_px * 14e-6 / 1.985, 1e-7) << i;
  }
}

TEST_F(OdometerTest, ParkedStaysAtRestAndCreepingDoesNot) {
  for (int i = 0; i < 150; ++i) {
    const StepReport parked = push_at(i, 0.0, 0.0);
    EXPECT_NE(parked.motion, MotionState::moving) << i;
    EXPECT_EQ(parked.motion == MotionState::at_rest, i >= 50) << i;
    EXPECT_NEAR(parked.position.x_m, 0.0, 0.005 * 14e-6 / 1.985) << i;
  }
  int moving = 0;
  double x_px = 0.0;
  for (int i = 150; i < 300; ++i) {
    x_px += 0.001;  // 20 frames to leave the place
    const StepReport creeping = push_at(i, x_px, 0.0);
    moving += creeping.motion == MotionState::moving ? 1 : 0;
    EXPECT_NEAR(creeping.position.x_m, x_px * 14e-6 / 1.985, 0.005 * 14e-6 / 1.985) << i;
  }
  EXPECT_GT(moving, 120);
}

// Frame after frame the keyframe stays; it changes before half of it has left the view.
TEST_F(OdometerTest, AKeyframeServesWhileItIsInView) {
  std::int64_t keyframe = 0;
  int changes = 0;
  for (int i = 0; i < 100; ++i) {
    const StepReport report = push_at(i, 2.0 * i, 0.0);
    if (report.keyframe == keyframe) continue;
    EXPECT_LE(2.0 * static_cast<double>(report.keyframe - keyframe), 0.5 * format_.width_px);
    keyframe = report.keyframe;
    ++changes;
  }
  EXPECT_GE(changes, 3);
  EXPECT_LE(changes, 12);
}

TEST_F(OdometerTest, SaturatedAndEvenFramesAreRefused) {
  push_at(0, 0.0, 0.0);
  EXPECT_EQ(push(constant(format_, 1, 255)).shift.status, ShiftStatus::saturated);
  EXPECT_EQ(push(constant(format_, 2, 255)).shift.status, ShiftStatus::saturated);
  push_at(3, 0.0, 0.0);
  EXPECT_EQ(push(constant(format_, 4, 90)).shift.status, ShiftStatus::low_contrast);
}

TEST_F(OdometerTest, AFrozenCameraIsNotStandstill) {
  push_at(0, 0.0, 0.0);
  Frame frame = simulated(camera_, 1, 1.0, 0.0);
  EXPECT_EQ(push(frame).shift.status, ShiftStatus::ok);
  frame.index = 2;
  frame.stamp = {2 * kPeriod_ns};
  EXPECT_EQ(push(frame).shift.status, ShiftStatus::frozen);
  // Real standstill differs by its noise.
  const StepReport parked = push_at(3, 1.0, 0.0);
  ASSERT_EQ(parked.shift.status, ShiftStatus::ok);
  EXPECT_NEAR(parked.shift.dx_px, 0.0, 0.005);
}

// The frame after a repeated one has moved since the first copy: twice the shift, twice the time.
TEST_F(OdometerTest, AfterARepeatedFrameTheSpeedIsStillRight) {
  push_at(0, 0.0, 0.0);
  Frame frame = simulated(camera_, 1, 2.3, 0.7);
  const StepReport before = push(frame);
  frame.index = 2;
  frame.stamp = {2 * kPeriod_ns};
  EXPECT_EQ(push(frame).shift.status, ShiftStatus::frozen);
  const StepReport after = push_at(3, 6.9, 2.1);
  ASSERT_EQ(after.shift.status, ShiftStatus::ok);
  EXPECT_EQ(after.dt_ns, 2 * kPeriod_ns);
  EXPECT_NEAR(after.shift.dx_px, 4.6, 0.02);
  EXPECT_NEAR(after.velocity.vx_m_s, before.velocity.vx_m_s, 1e-4);
}

// A stuck ring of two buffers hands out the frame before the last one again.
TEST_F(OdometerTest, AStuckPairOfBuffersIsFrozen) {
  const Frame first = simulated(camera_, 0, 0.0, 0.0);
  push(first);
  Frame second = simulated(camera_, 1, 4.0, 0.0);
  EXPECT_EQ(push(second).shift.status, ShiftStatus::ok);
  for (const std::int64_t i : {2, 3, 4, 5}) {
    FrameView again = i % 2 == 0 ? first.view() : second.view();
    again.index = i;
    again.stamp = {i * kPeriod_ns};
    EXPECT_EQ(odometer_.push(again).value().shift.status, ShiftStatus::frozen) << i;
  }
}

// 40 px are beyond the search range; the speed before the gap leads there.
TEST_F(OdometerTest, OneBadFrameInAFastDriveCostsNoDistance) {
  for (int i = 0; i < 6; ++i) push_at(i, 20.0 * i, 0.0);
  EXPECT_EQ(push(constant(format_, 6, 3)).shift.status, ShiftStatus::dark);
  const StepReport after = push_at(7, 140.0, 0.0);
  ASSERT_EQ(after.shift.status, ShiftStatus::ok);
  EXPECT_EQ(after.segment, 0);
  EXPECT_NEAR(after.shift.dx_px, 40.0, 0.01);
  EXPECT_EQ(push_at(8, 900.0, 0.0).shift.status, ShiftStatus::below_zncc_gate);
  EXPECT_NEAR(push_at(9, 180.0, 0.0).shift.dx_px, 40.0, 0.01);
}

TEST_F(OdometerTest, DarkFramesAtTheStartHaveNoInterval) {
  for (int i = 0; i < 3; ++i) {
    Frame dark = constant(format_, i, 3);
    dark.stamp = {1'700'000'000 * kNsPerS + i * kPeriod_ns};
    EXPECT_EQ(push(dark).dt_ns, 0) << i;
  }
}

TEST_F(OdometerTest, RestIsForgottenWithTheGround) {
  for (int i = 0; i < 60; ++i) push_at(i, 0.0, 0.0);
  push_at(60, 500.0, 0.0);
  const StepReport found = push_at(61, 500.0, 0.0);
  EXPECT_EQ(found.segment, 1);
  EXPECT_NE(found.motion, MotionState::at_rest);
}

TEST_F(OdometerTest, LookingAtThePlaneChangesNothing) {
  Odometer watched = Odometer::create(test::bridget_config(), format_).value();
  for (int i = 0; i < 12; ++i) {
    const Frame frame = simulated(camera_, i, 1.7 * i, 0.4 * i);
    const StepReport plain = push(frame);
    const StepReport other = watched.push(frame.view()).value();
    if (i == 0) continue;
    EXPECT_EQ(plain.shift.dx_px, other.shift.dx_px) << i;
    EXPECT_EQ(plain.shift.quality.q, other.shift.quality.q) << i;
    EXPECT_GT(watched.plane().at(2, 0), 0.5) << i;
  }
}

TEST(Odometer, RefusesPixelsAboveFullScaleAndOddAddresses) {
  const FrameFormat format{
      .width_px = 64, .height_px = 64, .type = PixelType::mono16, .bit_depth = 12};
  Odometer odometer = Odometer::create(test::bridget_config(), format).value();
  Frame frame(format);
  for (int y = 0; y < 64; ++y) std::fill_n(frame.row16(y), 64, std::uint16_t{700});
  frame.row16(63)[63] = 4096;
  EXPECT_FALSE(odometer.push(frame.view()));
  frame.row16(63)[63] = 4095;
  EXPECT_TRUE(odometer.push(frame.view()));
  FrameView odd = frame.view();
  odd.stamp = {kPeriod_ns};
  odd.data += 1;
  EXPECT_FALSE(odometer.push(odd));
}

TEST(Odometer, RefusesImpossibleFormatsAndSizes) {
  for (const FrameFormat& format :
       {FrameFormat{.width_px = 64, .height_px = 64, .bit_depth = 40},
        FrameFormat{.width_px = 64, .height_px = 64, .bit_depth = 7},
        FrameFormat{.width_px = 64, .height_px = 64, .type = PixelType::mono16, .bit_depth = -1},
        FrameFormat{.width_px = -64, .height_px = 64}}) {
    EXPECT_FALSE(Odometer::create(test::bridget_config(), format));
  }
}

TEST_F(OdometerTest, StampsAtTheEndsOfTimeAreRefused) {
  Frame first = simulated(camera_, 0, 0.0, 0.0);
  first.stamp = {std::numeric_limits<std::int64_t>::min()};
  push(first);
  Frame last = simulated(camera_, 1, 0.0, 0.0);
  last.stamp = {std::numeric_limits<std::int64_t>::max()};
  EXPECT_FALSE(odometer_.push(last.view()));
}

TEST(Odometer, NoiseFreeFramesMayRepeat) {
  TrackConfig config = test::bridget_config();
  config.calibration.noise_sd_counts = 0.0;
  sim::SpeckleCamera camera =
      sim::SpeckleCamera::create({.width_px = 64, .height_px = 64, .noise_sd_counts = 0.0}).value();
  Odometer odometer = Odometer::create(config, sim::frame_format(camera.config())).value();
  EXPECT_TRUE(odometer.push(simulated(camera, 0, 0.0, 0.0).view()));
  const StepReport repeat = odometer.push(simulated(camera, 1, 0.0, 0.0).view()).value();
  ASSERT_EQ(repeat.shift.status, ShiftStatus::ok);
  EXPECT_NEAR(repeat.shift.dx_px, 0.0, 1e-3);
}

TEST_F(OdometerTest, MotionBeyondTheSearchRangeIsNeverAccepted) {
  push_at(0, 0.0, 0.0);
  for (int i = 1; i <= 12; ++i) {
    const double jump_px = 41.0 * i;  // the range is +-32
    const StepReport report = push_at(i, jump_px, i % 2 == 0 ? 0.0 : 3.0 * i);
    EXPECT_NE(report.shift.status, ShiftStatus::ok) << i;
  }
}

TEST_F(OdometerTest, AWrongFormatOrStampIsRefusedAndTheOdometerGoesOn) {
  push_at(0, 0.0, 0.0);
  const Frame small = constant({.width_px = 64, .height_px = 80}, 1, 60);
  const Result<StepReport> wrong = odometer_.push(small.view());
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("frame 1 is 64 x 80 px"), std::string::npos);
  for (const std::int64_t stamp_ns : {std::int64_t{0}, -kPeriod_ns}) {
    Frame late = simulated(camera_, 1, 1.0, 0.0);
    late.stamp = {stamp_ns};
    EXPECT_FALSE(odometer_.push(late.view()));
  }
  const StepReport report = push_at(2, 2.0, 0.0);
  EXPECT_NEAR(report.shift.dx_px, 2.0, 0.02);
}

TEST(Odometer, RefusesSettingsThatDoNotFit) {
  TrackConfig config = test::bridget_config();
  config.correlation.max_shift_px = 60;
  EXPECT_FALSE(Odometer::create(config, {.width_px = 64, .height_px = 64}));
  EXPECT_FALSE(Odometer::create(test::bridget_config(), {.width_px = 8, .height_px = 64}));
  EXPECT_FALSE(Odometer::create(TrackConfig{}, {.width_px = 64, .height_px = 64}));
}

TEST(Odometer, KeepsTwelveBitFramesDeep) {
  const sim::SpeckleConfig deep{.width_px = 80, .height_px = 64, .bit_depth = 12};
  sim::SpeckleCamera camera = sim::SpeckleCamera::create(deep).value();
  Odometer odometer = Odometer::create(test::bridget_config(), sim::frame_format(deep)).value();
  EXPECT_TRUE(odometer.push(simulated(camera, 0, 0.0, 0.0).view()));
  const StepReport report = odometer.push(simulated(camera, 1, -3.4, 5.1).view()).value();
  ASSERT_EQ(report.shift.status, ShiftStatus::ok);
  EXPECT_NEAR(report.shift.dx_px, -3.4, 0.02);
  EXPECT_NEAR(report.shift.dy_px, 5.1, 0.02);
}

TEST(Odometer, SameFramesSameBits) {
  std::vector<double> runs[2];
  for (std::vector<double>& run : runs) {
    sim::SpeckleCamera camera = sim::SpeckleCamera::create({}).value();
    Odometer odometer =
        Odometer::create(test::bridget_config(), sim::frame_format(camera.config())).value();
    for (int i = 0; i < 6; ++i) {
      const StepReport report =
          odometer.push(simulated(camera, i, 1.7 * i, -0.4 * i).view()).value();
      for (const double value : {report.shift.dx_px, report.shift.cov.xx_px2,
                                 report.shift.quality.q, report.position.y_m})
        run.push_back(std::isnan(value) ? -1.0 : value);
    }
  }
  EXPECT_EQ(runs[0], runs[1]);
}

/// The lower third of the rows is that of another place, for good.
void put_strange_rows(Frame& frame, Frame& other) {
  const FrameView view = frame.view();
  for (int y = 2 * view.height_px() / 3; y < view.height_px(); ++y)
    std::copy_n(other.row8(y), view.width_px(), frame.row8(y));
}

// A torn frame is refused and leaves no trace; what is torn for good does not lock out.
TEST_F(OdometerTest, TornFramesAreRefusedAndNeverForGood) {
  Frame other = simulated(camera_, 0, 500.0, 500.0);
  std::int64_t k = 0;
  const auto step = [&](bool torn) {
    Frame frame = simulated(camera_, k, 1.3 * static_cast<double>(k), 0.4 * static_cast<double>(k));
    ++k;
    if (torn) put_strange_rows(frame, other);
    return push(frame);
  };
  while (k < 10) step(false);
  EXPECT_EQ(step(true).shift.status, ShiftStatus::inconsistent);
  const StepReport next = step(false);
  ASSERT_EQ(next.shift.status, ShiftStatus::ok);
  EXPECT_NEAR(next.shift.dx_px, 2.6, 0.01);
  EXPECT_EQ(next.segment, 0);
  while (k < 20) step(false);
  int refused = 0;
  while (refused < 40 && step(true).shift.status != ShiftStatus::ok) ++refused;
  EXPECT_GT(refused, 5);
  EXPECT_LE(refused, 20);
}

}  // namespace
}  // namespace lsv
