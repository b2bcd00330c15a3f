// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/peak.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "correlation/kernels.h"
#include "correlation/sinc_surface.h"

namespace lsv {
namespace {

/// The quadratic c + gx x + gy y + (hxx x^2 + 2 hxy x y + hyy y^2) / 2 around the centre lag.
struct Quadratic {
  double c, gx, gy, hxx, hxy, hyy;
};

/// f[row][column], rows dy = -1, 0, 1.
using Neighbourhood = std::array<std::array<double, 3>, 3>;

Neighbourhood neighbourhood(const CorrelationPlane& plane, int dx_px, int dy_px) {
  Neighbourhood f;
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i)
      f[static_cast<std::size_t>(j + 1)][static_cast<std::size_t>(i + 1)] =
          plane.at(dx_px + i, dy_px + j);
  }
  return f;
}

bool all_positive(const Neighbourhood& f) {
  return std::all_of(f.begin(), f.end(), [](const auto& row) {
    return std::all_of(row.begin(), row.end(), [](double v) { return v > 0.0; });
  });
}

void take_log(Neighbourhood& f) {
  for (auto& row : f) {
    for (double& value : row) value = std::log(value);
  }
}

/// Least squares over the nine lags; on a 3 x 3 grid the basis 1, x, y, x^2 - 2/3, y^2 - 2/3, xy
/// is orthogonal, so every coefficient is one weighted sum.
Quadratic fit_full(const Neighbourhood& f) {
  double mean = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      const double v = f[static_cast<std::size_t>(j + 1)][static_cast<std::size_t>(i + 1)];
      mean += v / 9.0;
      x += i * v / 6.0;
      y += j * v / 6.0;
      xx += (i * i - 2.0 / 3.0) * v / 2.0;
      yy += (j * j - 2.0 / 3.0) * v / 2.0;
      xy += i * j * v / 4.0;
    }
  }
  return {.c = mean - 2.0 / 3.0 * (xx + yy),
          .gx = x,
          .gy = y,
          .hxx = 2.0 * xx,
          .hxy = xy,
          .hyy = 2.0 * yy};
}

Quadratic fit_cross(const Neighbourhood& f) {
  const double centre = f[1][1];
  return {.c = centre,
          .gx = (f[1][2] - f[1][0]) / 2.0,
          .gy = (f[2][1] - f[0][1]) / 2.0,
          .hxx = f[1][2] - 2.0 * centre + f[1][0],
          .hxy = 0.0,
          .hyy = f[2][1] - 2.0 * centre + f[0][1]};
}

struct Maximum {
  double dx_px, dy_px, value;
  PeakShape shape;
  PeakFit fit = PeakFit::sinc;
};

/// Empty when the surface has no maximum within one lag of the centre.
std::optional<Maximum> maximum(const Quadratic& q) {
  const double det = q.hxx * q.hyy - q.hxy * q.hxy;
  if (!(q.hxx < 0.0) || !(q.hyy < 0.0) || !(det > 0.0)) return std::nullopt;
  const PeakShape shape{.xx_px2 = -q.hyy / det, .xy_px2 = q.hxy / det, .yy_px2 = -q.hxx / det};
  const double dx = shape.xx_px2 * q.gx + shape.xy_px2 * q.gy;
  const double dy = shape.xy_px2 * q.gx + shape.yy_px2 * q.gy;
  if (std::abs(dx) > 1.0 || std::abs(dy) > 1.0) return std::nullopt;
  return Maximum{dx, dy, q.c + 0.5 * (q.gx * dx + q.gy * dy), shape};
}

std::optional<Maximum> fit_lags(const Neighbourhood& lags, PeakFit fit) {
  Neighbourhood f = lags;
  if (fit == PeakFit::parabola3) {
    std::optional<Maximum> top = maximum(fit_cross(f));
    if (!top || !(top->value > 0.0)) return std::nullopt;
    // -(log f)'' = -f''/f at a maximum
    for (double* entry : {&top->shape.xx_px2, &top->shape.xy_px2, &top->shape.yy_px2})
      *entry *= top->value;
    top->fit = fit;
    return top;
  }
  if (!all_positive(f)) return std::nullopt;
  take_log(f);
  std::optional<Maximum> top = maximum(fit == PeakFit::gaussian2d ? fit_full(f) : fit_cross(f));
  if (!top) return std::nullopt;
  top->value = std::exp(top->value);
  top->fit = fit;
  return top;
}

/// Below this squared width the 3 x 3 fit errs less (simulator: the two meet at 2.3 px speckle).
bool is_undersampled(const PeakShape& shape) {
  constexpr double kNarrow_px2 = 1.1;
  return shape.xx_px2 * shape.yy_px2 - shape.xy_px2 * shape.xy_px2 < kNarrow_px2 * kNarrow_px2;
}

/// Newton steps on the interpolated plane, from the 3 x 3 fit or else from the highest lag.
std::optional<Maximum> fit_sinc(const CorrelationPlane& plane, int lag_dx_px, int lag_dy_px) {
  const Neighbourhood f = neighbourhood(plane, lag_dx_px, lag_dy_px);
  const std::optional<Maximum> narrow = fit_lags(f, PeakFit::gaussian2d);
  const int radius = std::min({kMaxSincRadius, plane.lags.max_dx_px - std::abs(lag_dx_px),
                               plane.lags.max_dy_px - std::abs(lag_dy_px)});
  if (radius < kMinSincRadius) return narrow;
  constexpr int kMaxSteps = 12;
  constexpr double kConverged_px = 1e-4;  // Newton: the step after one of 1e-4 is about 1e-8
  Maximum top = narrow.value_or(Maximum{});
  top.fit = PeakFit::sinc;
  for (int step = 0; step < kMaxSteps; ++step) {
    const SurfacePoint at = sinc_surface(plane, lag_dx_px, lag_dy_px, radius, lag_dx_px + top.dx_px,
                                         lag_dy_px + top.dy_px);
    const std::optional<Maximum> next = maximum(
        {.c = at.value, .gx = at.gx, .gy = at.gy, .hxx = at.hxx, .hxy = at.hxy, .hyy = at.hyy});
    if (!next || !(at.value > 0.0)) return std::nullopt;
    top.dx_px += next->dx_px;
    top.dy_px += next->dy_px;
    if (std::abs(top.dx_px) > 1.0 || std::abs(top.dy_px) > 1.0) return std::nullopt;
    top.value = next->value;
    top.shape = {.xx_px2 = next->shape.xx_px2 * at.value,
                 .xy_px2 = next->shape.xy_px2 * at.value,
                 .yy_px2 = next->shape.yy_px2 * at.value};
    if (std::abs(next->dx_px) < kConverged_px && std::abs(next->dy_px) < kConverged_px)
      return is_undersampled(top.shape) && narrow ? narrow : top;
  }
  return std::nullopt;
}

Peak& set_maximum(Peak& peak, const std::optional<Maximum>& top) {
  if (!top) return peak;
  peak.status = ShiftStatus::ok;
  peak.dx_px = peak.lag_dx_px + top->dx_px;
  peak.dy_px = peak.lag_dy_px + top->dy_px;
  peak.value = top->value;
  peak.shape = top->shape;
  peak.fit = top->fit;
  return peak;
}

}  // namespace

Peak fit_nine_lags(const std::array<double, 9>& values, int lag_dx_px, int lag_dy_px) {
  Neighbourhood f;
  for (std::size_t i = 0; i < values.size(); ++i) f[i / 3][i % 3] = values[i];
  Peak out{.lag_dx_px = lag_dx_px, .lag_dy_px = lag_dy_px, .lag_value = f[1][1]};
  return set_maximum(out, fit_lags(f, PeakFit::gaussian2d));
}

Peak find_peak(const CorrelationPlane& plane, PeakFit fit) {
  const std::size_t n = plane.values.size();
  const float highest = kernels::max_value(plane.values.data(), n);
  const float* const first = std::find(plane.values.data(), plane.values.data() + n, highest);
  Peak out;
  if (first == plane.values.data() + n) return out;  // the plane holds NaN
  const auto index = static_cast<int>(first - plane.values.data());
  out.lag_dx_px = index % plane.width() - plane.lags.max_dx_px;
  out.lag_dy_px = index / plane.width() - plane.lags.max_dy_px;
  out.lag_value = highest;
  if (std::abs(out.lag_dx_px) == plane.lags.max_dx_px ||
      std::abs(out.lag_dy_px) == plane.lags.max_dy_px) {
    out.status = ShiftStatus::peak_at_border;
    return out;
  }
  const std::optional<Maximum> top =
      fit == PeakFit::sinc ? fit_sinc(plane, out.lag_dx_px, out.lag_dy_px)
                           : fit_lags(neighbourhood(plane, out.lag_dx_px, out.lag_dy_px), fit);
  return set_maximum(out, top);
}

}  // namespace lsv
