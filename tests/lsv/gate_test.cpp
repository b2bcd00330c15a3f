// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/gate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/calibration.h"

namespace lsv {
namespace {

constexpr FrameFormat k8Bit{.width_px = 128, .height_px = 128};

ShiftStatus judge(double mean_counts, double sd_counts, double saturated_fraction) {
  return judge_frame(k8Bit,
                     {.mean_counts = mean_counts,
                      .sd_counts = sd_counts,
                      .saturated_fraction = saturated_fraction},
                     GateConfig{}, test::bridget_calibration());
}

TEST(JudgeFrame, GivesTheReason) {
  EXPECT_EQ(judge(60.0, 45.0, 0.01), ShiftStatus::ok);
  EXPECT_EQ(judge(12.0, 8.0, 0.0), ShiftStatus::ok);  // low light, still a pattern
  EXPECT_EQ(judge(3.0, 0.5, 0.0), ShiftStatus::dark);
  EXPECT_EQ(judge(0.0, 0.0, 0.0), ShiftStatus::dark);
  EXPECT_EQ(judge(255.0, 0.0, 1.0), ShiftStatus::saturated);
  EXPECT_EQ(judge(200.0, 80.0, 0.6), ShiftStatus::saturated);
  EXPECT_EQ(judge(128.0, 1.0, 0.0), ShiftStatus::low_contrast);
}

TEST(JudgeFrame, ScalesWithTheBitDepth) {
  const FrameStats dim{.mean_counts = 20.0, .sd_counts = 15.0, .saturated_fraction = 0.0};
  const FrameFormat deep{
      .width_px = 128, .height_px = 128, .type = PixelType::mono16, .bit_depth = 12};
  EXPECT_EQ(judge_frame(k8Bit, dim, GateConfig{}, test::bridget_calibration()), ShiftStatus::ok);
  EXPECT_EQ(judge_frame(deep, dim, GateConfig{}, test::bridget_calibration()), ShiftStatus::dark);
}

Shift good_shift() {
  Shift out;
  out.dx_px = 1.0;
  out.dy_px = -2.0;
  out.cov = {.xx_px2 = 1e-4, .xy_px2 = 0.0, .yy_px2 = 1e-4};
  out.quality = {
      .zncc = 0.9, .q = 30.0, .peak_ratio = 5.0, .peak_to_rms = 20.0, .zncc_sigmas = 30.0};
  out.status = ShiftStatus::ok;
  return out;
}

TEST(JudgeShift, EachGateHasItsReason) {
  const GateConfig gate;
  EXPECT_EQ(judge_shift(good_shift(), gate), ShiftStatus::ok);
  Shift low_zncc = good_shift();
  low_zncc.quality.zncc = gate.min_zncc - 0.01;
  EXPECT_EQ(judge_shift(low_zncc, gate), ShiftStatus::below_zncc_gate);
  Shift chance = good_shift();
  chance.quality.zncc_sigmas = gate.min_zncc_sigmas - 0.1;
  EXPECT_EQ(judge_shift(chance, gate), ShiftStatus::below_zncc_gate);
  Shift twin = good_shift();
  twin.quality.peak_ratio = gate.min_peak_ratio - 0.01;
  EXPECT_EQ(judge_shift(twin, gate), ShiftStatus::ambiguous);
  Shift low_q = good_shift();
  low_q.quality.q = gate.min_q - 0.1;
  EXPECT_EQ(judge_shift(low_q, gate), ShiftStatus::below_q_gate);
}

// At rest, with less resemblance than rest would have, and with a second peak beyond chance.
TEST(JudgeSearch, ASecondPeakBesideAPatternAtRest) {
  const GateConfig gate;
  Shift held = good_shift();
  held.dx_px = 0.1, held.dy_px = -0.1;
  held.quality.peak_ratio = 2.0;
  EXPECT_EQ(judge_search(held, gate), ShiftStatus::static_pattern);
  EXPECT_EQ(judge_shift(held, gate), ShiftStatus::ok);
  Shift moving = held;
  moving.dy_px = -2.0;
  EXPECT_EQ(judge_search(moving, gate), ShiftStatus::ok);
  Shift same = held;
  same.quality.zncc = 0.99;
  EXPECT_EQ(judge_search(same, gate), ShiftStatus::ok);
  Shift boiling = held;
  boiling.quality.peak_ratio = 5.0;
  EXPECT_EQ(judge_search(boiling, gate), ShiftStatus::ok);
  Shift twin = held;
  twin.quality.peak_ratio = gate.min_peak_ratio - 0.01;
  EXPECT_EQ(judge_search(twin, gate), ShiftStatus::ambiguous);
}

TEST(JudgeShift, UnknownQualityIsRefused) {
  for (double ShiftQuality::*member : {&ShiftQuality::zncc, &ShiftQuality::q,
                                       &ShiftQuality::peak_ratio, &ShiftQuality::zncc_sigmas}) {
    Shift shift = good_shift();
    shift.quality.*member = kUnknown;
    EXPECT_NE(judge_shift(shift, GateConfig{}), ShiftStatus::ok);
  }
}

TEST(JudgeShift, KeepsARefusalOfThePeak) {
  Shift shift = good_shift();
  shift.status = ShiftStatus::peak_at_border;
  EXPECT_EQ(judge_shift(shift, GateConfig{}), ShiftStatus::peak_at_border);
}

TEST(WithStatus, ARefusedShiftHasNoNumbersButKeepsItsQuality) {
  const Shift refused = with_status(good_shift(), ShiftStatus::ambiguous);
  EXPECT_TRUE(std::isnan(refused.dx_px));
  EXPECT_TRUE(std::isnan(refused.cov.yy_px2));
  EXPECT_EQ(refused.quality.q, 30.0);
  EXPECT_EQ(refused.status, ShiftStatus::ambiguous);
  EXPECT_EQ(with_status(good_shift(), ShiftStatus::ok).dx_px, 1.0);
}

TEST(JudgeRows, NeedsBothMoreThanChanceAndEnoughToMatter) {
  const ShiftCovariance sure{1e-8, 0.0, 1e-8}, unsure{1e-2, 0.0, 1e-2};
  const auto moved = [](double px, double sigmas) {
    return RowAgreement{.moved_px = px, .moved_sigmas = sigmas};
  };
  EXPECT_EQ(judge_rows({}, sure), ShiftStatus::ok);
  EXPECT_EQ(judge_rows(moved(0.05, 8.0), sure), ShiftStatus::inconsistent);
  EXPECT_EQ(judge_rows(moved(0.05, 3.0), sure), ShiftStatus::ok);
  EXPECT_EQ(judge_rows(moved(0.005, 8.0), sure), ShiftStatus::ok);
  EXPECT_EQ(judge_rows(moved(0.05, 8.0), unsure), ShiftStatus::ok);
  EXPECT_EQ(judge_rows({.changed = 0.4, .changed_sigmas = 8.0}, unsure), ShiftStatus::inconsistent);
  EXPECT_EQ(judge_rows({.changed = 0.05, .changed_sigmas = 30.0}, sure), ShiftStatus::ok);
}

}  // namespace
}  // namespace lsv
