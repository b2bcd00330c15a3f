// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/sinc_surface.h"

#include <cmath>
#include <numbers>

namespace lsv {
namespace {

/// Value, first and second derivative of something along one axis.
struct Jet {
  double f = 0.0, d1 = 0.0, d2 = 0.0;
};

Jet operator*(const Jet& a, const Jet& b) {
  return {a.f * b.f, a.d1 * b.f + a.f * b.d1, a.d2 * b.f + 2.0 * a.d1 * b.d1 + a.f * b.d2};
}

/// sinc(t) with sin(pi t) and cos(pi t) given.
Jet sinc(double t, double sin_pi_t, double cos_pi_t) {
  constexpr double kPi = std::numbers::pi;
  if (std::abs(t) < 1e-3) {  // series: the quotients below cancel near zero
    const double pi2 = kPi * kPi;
    const double t2 = t * t;
    return {1.0 - pi2 * t2 / 6.0, -pi2 * t / 3.0 + pi2 * pi2 * t * t2 / 30.0,
            -pi2 / 3.0 + pi2 * pi2 * t2 / 10.0};
  }
  const double s = sin_pi_t / (kPi * t);
  const double d1 = (cos_pi_t - s) / t;
  return {s, d1, -kPi * kPi * s - 2.0 * d1 / t};
}

Jet gaussian(double t, double variance) {
  const double g = std::exp(-0.5 * t * t / variance);
  return {g, -t / variance * g, (t * t / variance - 1.0) / variance * g};
}

using Weights = std::array<Jet, 2 * kMaxSincRadius + 1>;

/// Weights of the samples at -radius .. radius for the point at `offset`, summing to one.
Weights weights(double offset, int radius) {
  // A narrower window blurs the band edge, a wider one is cut off at its ends; 0.7 was the best
  // compromise on simulated speckle of 3 to 9 px and on printed targets.
  const double variance = radius * 0.7;
  const double sin_offset = std::sin(std::numbers::pi * offset);
  const double cos_offset = std::cos(std::numbers::pi * offset);
  Weights w;
  Jet sum;
  for (int i = -radius; i <= radius; ++i) {
    const double t = offset - i;
    Jet& jet = w[static_cast<std::size_t>(i + radius)];
    const double sign = i % 2 == 0 ? 1.0 : -1.0;  // sin(pi (offset - i)) = sign sin(pi offset)
    jet = sinc(t, sign * sin_offset, sign * cos_offset) * gaussian(t, variance);
    sum.f += jet.f;
    sum.d1 += jet.d1;
    sum.d2 += jet.d2;
  }
  for (Jet& jet : w) {
    jet.f /= sum.f;
    jet.d1 = (jet.d1 - jet.f * sum.d1) / sum.f;
    jet.d2 = (jet.d2 - 2.0 * jet.d1 * sum.d1 - jet.f * sum.d2) / sum.f;
  }
  return w;
}

}  // namespace

SurfacePoint sinc_surface(const CorrelationPlane& plane, int lag_dx_px, int lag_dy_px, int radius,
                          double dx_px, double dy_px) {
  const Weights wx = weights(dx_px - lag_dx_px, radius);
  const Weights wy = weights(dy_px - lag_dy_px, radius);
  SurfacePoint out{};
  for (int j = -radius; j <= radius; ++j) {
    const float* const row = plane.row(lag_dy_px + j) + plane.lags.max_dx_px + lag_dx_px - radius;
    Jet along;
    for (std::size_t i = 0; i < static_cast<std::size_t>(2 * radius + 1); ++i) {
      const double v = row[i];
      along.f += wx[i].f * v;
      along.d1 += wx[i].d1 * v;
      along.d2 += wx[i].d2 * v;
    }
    const Jet& w = wy[static_cast<std::size_t>(j + radius)];
    out.value += w.f * along.f;
    out.gx += w.f * along.d1;
    out.gy += w.d1 * along.f;
    out.hxx += w.f * along.d2;
    out.hxy += w.d1 * along.d1;
    out.hyy += w.d2 * along.f;
  }
  return out;
}

}  // namespace lsv
