// SPDX-License-Identifier: BSD-3-Clause
// Band-limited interpolation of samples on a unit grid with a Gaussian-windowed sinc (regularised
// sampling; Qian, "On the regularized Whittaker-Kotel'nikov-Shannon sampling formula", 2003),
// weights normalised so that a constant is reproduced exactly; with first and second derivatives.
#pragma once

#include <array>

#include "correlation/correlator.h"

namespace lsv {

struct SurfacePoint {
  double value;
  double gx, gy;
  double hxx, hxy, hyy;
};

inline constexpr int kMinSincRadius = 5;
inline constexpr int kMaxSincRadius = 8;

/// The plane at (dx_px, dy_px) from the (2 radius + 1)^2 lags around the whole lag
/// (lag_dx_px, lag_dy_px), which must all lie inside the plane. 1 <= radius <= kMaxSincRadius;
/// |dx_px - lag_dx_px| <= 1, dy alike.
SurfacePoint sinc_surface(const CorrelationPlane& plane, int lag_dx_px, int lag_dy_px, int radius,
                          double dx_px, double dy_px);

}  // namespace lsv
