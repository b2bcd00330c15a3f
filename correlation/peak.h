// SPDX-License-Identifier: BSD-3-Clause
// The one sub-pixel implementation: the highest lag of a plane and a model of the surface around
// it.
//   sinc        the plane is band-limited like the images, so it is interpolated with a
//               Gaussian-windowed sinc over up to 17 x 17 lags and its maximum found by Newton
//               steps. The default: nothing is assumed about the shape of the peak, which is
//               narrow and broad at once on textured ground.
//   gaussian2d  log plane = quadratic in (dx, dy) with cross term, least squares over 3 x 3 lags
//   gaussian3   separable: log parabola through 3 lags per axis
//   parabola3   separable: parabola through 3 lags per axis
// sinc gives way to gaussian2d where it does not apply: with fewer than 5 lags between the peak and
// the edge of the plane, and on a peak so narrow (speckle of about 2 px and less) that the plane is
// sampled too coarsely, where interpolation is pulled towards whole lags.
#pragma once

#include <array>

#include "correlation/correlator.h"
#include "lsv/core/config.h"
#include "lsv/core/shift.h"

namespace lsv {

/// Width of the peak as the inverse Hessian of its logarithm: the covariance matrix of the
/// Gaussian that it resembles, px^2.
struct PeakShape {
  double xx_px2 = kUnknown;
  double xy_px2 = kUnknown;
  double yy_px2 = kUnknown;
};

struct Peak {
  ShiftStatus status = ShiftStatus::flat_peak;  // ok, peak_at_border or flat_peak
  PeakFit fit = PeakFit::sinc;                  // the model that was used
  int lag_dx_px = 0;                            // the highest whole lag, always set
  int lag_dy_px = 0;
  double lag_value = kUnknown;  // the plane there
  double dx_px = kUnknown;      // sub-pixel position; NaN unless ok
  double dy_px = kUnknown;
  double value = kUnknown;  // the model at its maximum; NaN unless ok
  PeakShape shape{};        // NaN unless ok
};

Peak find_peak(const CorrelationPlane& plane, PeakFit fit);

/// The gaussian2d model through nine lags, row by row, around (lag_dx_px, lag_dy_px). `ok` or
/// `flat_peak`; the middle lag need not be the highest.
Peak fit_nine_lags(const std::array<double, 9>& values, int lag_dx_px, int lag_dy_px);

}  // namespace lsv
