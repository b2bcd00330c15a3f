// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/speckle_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace lsv {
namespace {

// Weights between two phases are interpolated linearly: 1/512 px keeps their error below 3e-6.
constexpr int kPhases = 512;
// Pixel noise that the weights expect, as a fraction of the variance of the pattern. It keeps the
// equations well conditioned; for derivatives, where noise costs more than bias, it is larger.
constexpr double kValueNoise = 1e-5;
constexpr double kDerivativeNoise = 1e-4;

// (2 J1(x) / x)^2 is one half here.
constexpr double kHalfMaximumArgument = 1.616340;

/// Autocovariance of the intensity at a point, as a fraction of its variance.
double speckle_autocovariance(double lag_px, double fwhm_px) {
  const double x = 2.0 * kHalfMaximumArgument * std::abs(lag_px) / fwhm_px;
  if (x < 1e-6) return 1.0;
  const double amplitude = 2.0 * std::cyl_bessel_j(1.0, x) / x;
  return amplitude * amplitude;
}

/// The same after averaging along one side of a square pixel: convolved with a triangle.
class PixelAutocovariance {
 public:
  explicit PixelAutocovariance(double fwhm_px) : values_(kReach_px * kPerPx + 1) {
    std::vector<double> points(values_.size() + kPerPx);
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] = speckle_autocovariance(static_cast<double>(i) / kPerPx, fwhm_px);
    constexpr int kStep = kPerPx / 16;
    for (int i = 0; std::cmp_less(i, values_.size()); ++i) {
      double sum = 0.0;
      for (int k = -kPerPx; k <= kPerPx; k += kStep)
        sum += (kPerPx - std::abs(k)) * points[static_cast<std::size_t>(std::abs(i + k))];
      values_[static_cast<std::size_t>(i)] = sum * kStep / (kPerPx * kPerPx);
    }
  }

  /// `lag` counts steps of 1 / kPerPx px.
  double at(int lag) const { return values_[static_cast<std::size_t>(std::abs(lag))]; }

  static constexpr int kPerPx = kPhases;

 private:
  static constexpr int kReach_px = 2 * kGradientReach_px + 1;
  std::vector<double> values_;
};

using Matrix = std::vector<std::vector<double>>;

/// Gauss-Jordan with partial pivoting; the matrices here are regular by kValueNoise.
Matrix inverse(Matrix a) {
  const std::size_t n = a.size();
  Matrix out(n, std::vector<double>(n, 0.0));
  for (std::size_t i = 0; i < n; ++i) out[i][i] = 1.0;
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < n; ++row) {
      if (std::abs(a[row][column]) > std::abs(a[pivot][column])) pivot = row;
    }
    std::swap(a[column], a[pivot]);
    std::swap(out[column], out[pivot]);
    const double scale = 1.0 / a[column][column];
    for (std::size_t k = 0; k < n; ++k) {
      a[column][k] *= scale;
      out[column][k] *= scale;
    }
    for (std::size_t row = 0; row < n; ++row) {
      if (row == column) continue;
      const double factor = a[row][column];
      for (std::size_t k = 0; k < n; ++k) {
        a[row][k] -= factor * a[column][k];
        out[row][k] -= factor * out[column][k];
      }
    }
  }
  return out;
}

/// Covariances of pixels first..first + count - 1 among each other, with noise on the diagonal.
Matrix pixel_covariance(const PixelAutocovariance& c, int count, double noise) {
  const auto n = static_cast<std::size_t>(count);
  Matrix out(n, std::vector<double>(n));
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      out[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          c.at((i - j) * PixelAutocovariance::kPerPx) + (i == j ? noise : 0.0);
    }
  }
  return out;
}

/// The covariance matrix bordered by ones: kriging with the sum of the weights held at 1.
Matrix bordered(Matrix covariance) {
  for (auto& row : covariance) row.push_back(1.0);
  covariance.emplace_back(covariance.size() + 1, 1.0);
  covariance.back().back() = 0.0;
  return covariance;
}

std::vector<KernelWeights> value_weights(const PixelAutocovariance& c, int taps) {
  const Matrix solve = bordered(pixel_covariance(c, taps, kValueNoise));
  const Matrix inverted = inverse(solve);
  const int left = taps / 2 - 1;
  const int first = kKernelLeft_px - left;
  std::vector<KernelWeights> out(kPhases + 1);
  for (int phase = 0; phase <= kPhases; ++phase) {
    std::vector<double> target(static_cast<std::size_t>(taps) + 1, 1.0);
    for (int j = 0; j < taps; ++j)
      target[static_cast<std::size_t>(j)] = c.at((j - left) * PixelAutocovariance::kPerPx - phase);
    for (int i = 0; i < taps; ++i) {
      double weight = 0.0;
      for (std::size_t j = 0; j < target.size(); ++j)
        weight += inverted[static_cast<std::size_t>(i)][j] * target[j];
      out[static_cast<std::size_t>(phase)][static_cast<std::size_t>(first + i)] =
          static_cast<float>(weight);
    }
  }
  return out;
}

std::array<float, kGradientReach_px> derivative_weights(const PixelAutocovariance& c) {
  constexpr int kCount = 2 * kGradientReach_px + 1;
  const Matrix inverted = inverse(pixel_covariance(c, kCount, kDerivativeNoise));
  std::array<double, kCount> target{};
  for (int j = 0; j < kCount; ++j) {
    const int lag = (j - kGradientReach_px) * PixelAutocovariance::kPerPx;
    target[static_cast<std::size_t>(j)] =
        (c.at(lag - 1) - c.at(lag + 1)) * PixelAutocovariance::kPerPx / 2.0;
  }
  std::array<double, kGradientReach_px> raw{};
  double slope = 0.0;
  for (int i = 1; i <= kGradientReach_px; ++i) {
    for (std::size_t j = 0; j < kCount; ++j)
      raw[static_cast<std::size_t>(i - 1)] +=
          inverted[static_cast<std::size_t>(kGradientReach_px + i)][j] * target[j];
    slope += 2.0 * i * raw[static_cast<std::size_t>(i - 1)];
  }
  std::array<float, kGradientReach_px> out{};
  // A ramp of 1 count per px must read 1.
  std::transform(raw.begin(), raw.end(), out.begin(),
                 [slope](double w) { return static_cast<float>(w / slope); });
  return out;
}

constexpr double kSmallestFwhm_px = 1.5;
constexpr double kFwhmStep = 1.15;
constexpr int kKernels = 14;

}  // namespace

SpeckleKernel::SpeckleKernel(double fwhm_px)
    : fwhm_px_(fwhm_px), taps_(fwhm_px < kSixTapFwhm_px ? 8 : 6) {
  const PixelAutocovariance c(fwhm_px);
  phases_ = value_weights(c, taps_);
  derivative_1_px_ = derivative_weights(c);
}

KernelWeights SpeckleKernel::weights(double fraction_px) const {
  const double phase = std::clamp(fraction_px, 0.0, 1.0) * kPhases;
  const auto below = std::min(static_cast<std::size_t>(phase), std::size_t{kPhases - 1});
  const auto share = static_cast<float>(phase - static_cast<double>(below));
  KernelWeights out;
  for (std::size_t j = 0; j < out.size(); ++j)
    out[j] = phases_[below][j] + share * (phases_[below + 1][j] - phases_[below][j]);
  return out;
}

const SpeckleKernel& speckle_kernel(double fwhm_px) {
  static const std::vector<SpeckleKernel> kernels = [] {
    std::vector<SpeckleKernel> out;
    double size_px = kSmallestFwhm_px;
    for (int i = 0; i < kKernels; ++i, size_px *= kFwhmStep) out.emplace_back(size_px);
    return out;
  }();
  const SpeckleKernel* best = &kernels.front();
  for (const SpeckleKernel& kernel : kernels) {
    if (kernel.fwhm_px() <= fwhm_px) best = &kernel;
  }
  return *best;
}

double speckle_fwhm_px(double variance_px2) {
  // (2 J1(x) / x)^2 falls as exp(-x^2 / 4).
  return std::sqrt(2.0 * variance_px2) * kHalfMaximumArgument;
}

}  // namespace lsv
