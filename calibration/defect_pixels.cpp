// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/defect_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "calibration/robust.h"

namespace lsv {
namespace {

constexpr int kReach_px = 3;
constexpr double kQuantisationVariance_counts2 = 1.0 / 12.0;
// A pixel that sits on the edge between two counts changes between them with this variance.
constexpr double kEdgeVariance_counts2 = 0.25;
constexpr double kLeastResponse_ratio = 0.1;
// Offset and response may stand out to either side, the noise to one.
constexpr double kTails = 5.0;

/// Of deviations about 0.
double robust_sigma(std::vector<double> deviations) {
  for (double& value : deviations) value = std::abs(value);
  return sigma_of_median(median(std::move(deviations)));
}

/// Where one tail of the normal distribution holds `probability`.
double normal_quantile(double probability) {
  double low = 0.0;
  double high = 40.0;
  for (int i = 0; i < 60; ++i) {
    const double z = 0.5 * (low + high);
    (0.5 * std::erfc(z / std::numbers::sqrt2) > probability ? low : high) = z;
  }
  return high;
}

/// Each value less the median of those around it. Itself among them, it would draw the median
/// along, and small deviations would seem smaller than they are.
std::vector<double> local_deviation(const std::vector<double>& values, int width_px,
                                    int height_px) {
  std::vector<double> out(values.size());
  std::array<double, (2 * kReach_px + 1) * (2 * kReach_px + 1)> around{};
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      auto end = around.begin();
      for (int v = std::max(0, y - kReach_px); v <= std::min(height_px - 1, y + kReach_px); ++v) {
        const auto row = values.begin() + static_cast<std::ptrdiff_t>(v) * width_px;
        const auto first = row + std::max(0, x - kReach_px);
        const auto last = row + std::min(width_px - 1, x + kReach_px);
        if (v != y) {
          end = std::copy(first, last + 1, end);
        } else {
          end = std::copy(first, row + x, end);
          end = std::copy(row + x + 1, last + 1, end);
        }
      }
      const auto middle = around.begin() + (end - around.begin()) / 2;
      std::nth_element(around.begin(), middle, end);
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                     static_cast<std::size_t>(x);
      out[i] = values[i] - *middle;
    }
  }
  return out;
}

template <typename Value>
std::vector<double> of_each_pixel(std::size_t pixels, Value value) {
  std::vector<double> out(pixels);
  for (std::size_t i = 0; i < pixels; ++i) out[i] = value(i);
  return out;
}

/// Variance over time of the mean of a typical pixel, with rounding.
double mean_variance_counts2(const PixelStatistics& sequence) {
  const double typical = median(of_each_pixel(
      sequence.pixels(), [&](std::size_t i) { return sequence.variance_counts2(i); }));
  return (typical + kQuantisationVariance_counts2) / static_cast<double>(sequence.frames());
}

double cube(double value) { return value * value * value; }

}  // namespace

DefectPixels find_dark_defects(const PixelStatistics& dark) {
  const std::size_t pixels = dark.pixels();
  DefectPixels out;
  out.defect.assign(pixels, 0);
  out.limits.sigmas = normal_quantile(kFalseDefects / (kTails * static_cast<double>(pixels)));

  const std::vector<double> offset =
      local_deviation(of_each_pixel(pixels, [&](std::size_t i) { return dark.mean_counts(i); }),
                      dark.format().width_px, dark.format().height_px);
  out.limits.offset_counts =
      out.limits.sigmas * std::max(robust_sigma(offset), std::sqrt(mean_variance_counts2(dark)));

  std::vector<double> root =
      of_each_pixel(pixels, [&](std::size_t i) { return std::cbrt(dark.variance_counts2(i)); });
  const double middle = median(root);
  for (double& value : root) value -= middle;
  const double frames = static_cast<double>(dark.frames());
  // Counts come in steps and so does the scatter; it is not less than chance makes it.
  const double chance = middle * std::sqrt(2.0 / (9.0 * (frames - 1.0)));
  constexpr double kRounding = 1.0 + 1e-9;  // of the sums that made the variances
  const double noise_limit_counts2 =
      kRounding * std::max(cube(middle + out.limits.sigmas * std::max(robust_sigma(root), chance)),
                           kEdgeVariance_counts2 * frames / (frames - 1.0));
  out.limits.noise_counts = std::sqrt(noise_limit_counts2);

  for (std::size_t i = 0; i < pixels; ++i) {
    const bool hot =
        offset[i] > out.limits.offset_counts || dark.variance_counts2(i) > noise_limit_counts2;
    const bool dead = !hot && offset[i] < -out.limits.offset_counts;
    out.defect[i] = hot || dead ? 1 : 0;
    out.counts.hot += hot ? 1 : 0;
    out.counts.dead += dead ? 1 : 0;
  }
  return out;
}

void add_lit_defects(const PixelStatistics& dark, const PixelStatistics& flat, DefectPixels& out) {
  const int width_px = dark.format().width_px;
  const int height_px = dark.format().height_px;
  const std::size_t pixels = dark.pixels();
  const std::vector<double> signal = of_each_pixel(
      pixels, [&](std::size_t i) { return flat.mean_counts(i) - dark.mean_counts(i); });
  std::vector<double> response = local_deviation(signal, width_px, height_px);
  // Of the light around each pixel.
  for (std::size_t i = 0; i < pixels; ++i) response[i] /= std::max(signal[i] - response[i], 1e-9);
  const double middle_counts = median(signal);
  const double noise_ratio =
      std::sqrt(mean_variance_counts2(dark) + mean_variance_counts2(flat)) / middle_counts;
  out.limits.response_ratio =
      std::min(out.limits.sigmas * std::max(robust_sigma(response), noise_ratio),
               1.0 - kLeastResponse_ratio);
  for (std::size_t i = 0; i < pixels; ++i) {
    const bool stuck = dark.variance_counts2(i) == 0.0 && flat.variance_counts2(i) == 0.0 &&
                       dark.mean_counts(i) == flat.mean_counts(i);
    out.counts.stuck += stuck ? 1 : 0;
    if (out.defect[i] != 0) continue;
    const bool dead = stuck || std::abs(response[i]) > out.limits.response_ratio;
    out.defect[i] = dead ? 1 : 0;
    out.counts.dead += dead ? 1 : 0;
  }
}

}  // namespace lsv
