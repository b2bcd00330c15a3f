// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/peak.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace lsv {
namespace {

constexpr PeakFit kFits[] = {PeakFit::gaussian2d, PeakFit::gaussian3, PeakFit::parabola3};

CorrelationPlane plane_of(const LagRange& lags, const std::function<double(int, int)>& value) {
  CorrelationPlane plane{.lags = lags,
                         .values = AlignedBuffer<float>(static_cast<std::size_t>(
                             (2 * lags.max_dx_px + 1) * (2 * lags.max_dy_px + 1)))};
  std::size_t i = 0;
  for (int dy = -lags.max_dy_px; dy <= lags.max_dy_px; ++dy) {
    for (int dx = -lags.max_dx_px; dx <= lags.max_dx_px; ++dx)
      plane.values[i++] = static_cast<float>(value(dx, dy));
  }
  return plane;
}

/// exp(-d' W^-1 d / 2), d from (x0, y0).
CorrelationPlane gaussian(const LagRange& lags, double x0, double y0, double xx, double xy,
                          double yy) {
  const double det = xx * yy - xy * xy;
  return plane_of(lags, [=](int dx, int dy) {
    const double x = dx - x0, y = dy - y0;
    return 0.8 * std::exp(-0.5 * (yy * x * x - 2.0 * xy * x * y + xx * y * y) / det);
  });
}

TEST(FindPeak, RecoversAnUprightGaussianExactly) {
  const LagRange lags{9, 5};  // not square: rows and columns cannot be mixed up unnoticed
  for (const PeakFit fit : {PeakFit::gaussian2d, PeakFit::gaussian3}) {
    for (const double x0 : {-6.3, -0.5, 0.0, 1e-8, 0.49, 7.1}) {
      for (const double y0 : {-3.4, 0.0, 0.5, 2.25}) {
        const Peak peak = find_peak(gaussian(lags, x0, y0, 2.0, 0.0, 3.0), fit);
        ASSERT_EQ(peak.status, ShiftStatus::ok);
        EXPECT_NEAR(peak.dx_px, x0, 2e-6);
        EXPECT_NEAR(peak.dy_px, y0, 2e-6);
        EXPECT_NEAR(peak.value, 0.8, 1e-5);
        EXPECT_NEAR(peak.shape.xx_px2, 2.0, 1e-4);
        EXPECT_NEAR(peak.shape.yy_px2, 3.0, 1e-4);
      }
    }
  }
}

TEST(FindPeak, OnlyTheTwoDimensionalFitFollowsALeaningPeak) {
  const CorrelationPlane plane = gaussian({6, 6}, 1.3, -2.4, 4.0, 2.0, 3.0);
  const Peak full = find_peak(plane, PeakFit::gaussian2d);
  ASSERT_EQ(full.status, ShiftStatus::ok);
  EXPECT_NEAR(full.dx_px, 1.3, 2e-6);
  EXPECT_NEAR(full.dy_px, -2.4, 2e-6);
  EXPECT_NEAR(full.shape.xy_px2, 2.0, 1e-4);
  const Peak separable = find_peak(plane, PeakFit::gaussian3);
  EXPECT_GT(std::hypot(separable.dx_px - 1.3, separable.dy_px + 2.4), 0.05);
}

TEST(FindPeak, RecoversAParabola) {
  const CorrelationPlane plane = plane_of({4, 4}, [](int dx, int dy) {
    return 1.0 - 0.05 * (dx - 0.3) * (dx - 0.3) - 0.08 * (dy + 1.2) * (dy + 1.2);
  });
  const Peak peak = find_peak(plane, PeakFit::parabola3);
  ASSERT_EQ(peak.status, ShiftStatus::ok);
  EXPECT_NEAR(peak.dx_px, 0.3, 1e-5);
  EXPECT_NEAR(peak.dy_px, -1.2, 1e-5);
  EXPECT_NEAR(peak.value, 1.0, 1e-6);
  EXPECT_NEAR(peak.shape.xx_px2, 1.0 / 0.1, 1e-3);
}

TEST(FindPeak, MirroredPlaneGivesTheMirroredPeak) {
  const CorrelationPlane plane = gaussian({5, 7}, 1.37, -2.6, 3.0, 0.7, 2.0);
  const CorrelationPlane mirrored =
      plane_of(plane.lags, [&](int dx, int dy) { return plane.at(-dx, -dy); });
  for (const PeakFit fit : kFits) {
    const Peak a = find_peak(plane, fit);
    const Peak b = find_peak(mirrored, fit);
    EXPECT_NEAR(a.dx_px, -b.dx_px, 1e-6) << word(fit);
    EXPECT_NEAR(a.dy_px, -b.dy_px, 1e-6) << word(fit);
  }
}

TEST(FindPeak, RisingToTheEdgeIsABorderPeak) {
  for (const PeakFit fit : kFits) {
    for (const double edge : {-5.0, 5.0}) {
      EXPECT_EQ(find_peak(gaussian({5, 5}, edge, 0.0, 2.0, 0.0, 2.0), fit).status,
                ShiftStatus::peak_at_border);
      EXPECT_EQ(find_peak(gaussian({5, 5}, 0.0, edge, 2.0, 0.0, 2.0), fit).status,
                ShiftStatus::peak_at_border);
    }
  }
}

TEST(FindPeak, RefusesWhatHasNoPeak) {
  for (const PeakFit fit : kFits) {
    // A ridge along x: the maximum is anywhere on it.
    const auto ridge = [](int, int dy) { return std::exp(-0.5 * dy * dy); };
    EXPECT_NE(find_peak(plane_of({3, 3}, ridge), fit).status, ShiftStatus::ok) << word(fit);
    const Peak constant = find_peak(plane_of({3, 3}, [](int, int) { return 0.5; }), fit);
    EXPECT_NE(constant.status, ShiftStatus::ok);
    EXPECT_TRUE(std::isnan(constant.dx_px));
    const Peak nan = find_peak(plane_of({3, 3}, [](int, int) { return kUnknown; }), fit);
    EXPECT_EQ(nan.status, ShiftStatus::flat_peak);
  }
  // A lone spike between negative neighbours has no logarithm.
  const auto spike = [](int dx, int dy) { return dx == 0 && dy == 0 ? 1.0 : -0.1; };
  EXPECT_EQ(find_peak(plane_of({3, 3}, spike), PeakFit::gaussian2d).status, ShiftStatus::flat_peak);
}

TEST(FindPeak, TwoEqualLagsGiveTheMiddle) {
  for (const PeakFit fit : kFits) {
    const Peak peak = find_peak(gaussian({5, 5}, 2.5, 0.0, 2.0, 0.0, 2.0), fit);
    ASSERT_EQ(peak.status, ShiftStatus::ok) << word(fit);
    EXPECT_NEAR(peak.dx_px, 2.5, 0.02) << word(fit);
  }
}

}  // namespace
}  // namespace lsv
