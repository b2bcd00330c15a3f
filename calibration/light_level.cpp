// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/light_level.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace lsv {
namespace {

constexpr double kPi2 = std::numbers::pi * std::numbers::pi;

double squared(double value) { return value * value; }

double root_sum_of_squares(std::initializer_list<double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum);
}

// A level lies anywhere between two counts, and the error of rounding goes round with its place:
// the first harmonic of the characteristic function of a rounded Gaussian (B. Widrow and I. Kollar,
// Quantization Noise, Cambridge 2008, appendix G). It dies away with the noise, and on average over
// pixels with the spread of their levels. It is the same in every recording, so its amplitude, and
// not a mean over all places, is taken for one sigma.

/// What rounding does to a variance beyond adding sigma_q^2, at most.
double rounding_of_variance_counts2(double variance_counts2, double spread_counts2) {
  return (1.0 / kPi2 + 4.0 * variance_counts2) *
         std::exp(-2.0 * kPi2 * (variance_counts2 + spread_counts2));
}

/// And to a mean.
double rounding_of_mean_counts(double variance_counts2, double spread_counts2) {
  return std::exp(-2.0 * kPi2 * (variance_counts2 + spread_counts2)) / std::numbers::pi;
}

/// Sums over the good pixels.
struct Sums {
  double good = 0.0;
  double mean = 0.0;  // from that of the frames
  double mean2 = 0.0;
  double light = 0.0;
  double light2 = 0.0;
  double variance = 0.0;
  double clipped = 0.0;
  double pairs = 0.0;
  double steps2 = 0.0;  // between the variances of neighbours: their scatter, not uneven light
};

Sums summed(const PixelStatistics& sequence, const std::vector<std::uint8_t>& defect,
            const PixelStatistics* dark) {
  Sums out;
  const auto width = static_cast<std::size_t>(sequence.format().width_px);
  for (std::size_t i = 0; i < sequence.pixels(); ++i) {
    if (defect[i] != 0) continue;
    const double mean = sequence.mean_counts(i) - sequence.frame_mean_counts();
    const double variance = sequence.variance_counts2(i);
    // The dark level drifts alike in all pixels.
    const double light = dark != nullptr ? sequence.mean_counts(i) - dark->mean_counts(i) : 1.0;
    out.good += 1.0;
    out.mean += mean;
    out.mean2 += mean * mean;
    out.light += light;
    out.light2 += light * light;
    out.variance += variance;
    out.clipped += dark != nullptr ? sequence.times_full(i) : sequence.times_zero(i);
    if ((i + 1) % width == 0 || defect[i + 1] != 0) continue;
    out.pairs += 1.0;
    out.steps2 += squared(sequence.variance_counts2(i + 1) - variance);
  }
  return out;
}

/// Standard deviation of the mean of the variances of the pixels.
double scatter_counts2(const Sums& sums, double frames, double noise, double flicker) {
  const double measured = 0.5 * sums.steps2 / std::max(sums.pairs, 1.0);
  // Flicker scatters the variances, too, but what all pixels share is taken out again.
  const double by_flicker = 4.0 * flicker * noise / (frames - 1.0);
  const double gaussian = 2.0 * noise * noise / (frames - 1.0);
  return std::sqrt(std::max(measured - by_flicker, gaussian) / sums.good);
}

}  // namespace

LightLevel light_level(const PixelStatistics& sequence, const std::vector<std::uint8_t>& defect,
                       const PixelStatistics* dark) {
  const Sums sums = summed(sequence, defect, dark);
  const auto frames = static_cast<double>(sequence.frames());
  const double mean = sums.mean / sums.good;
  const double spread = sums.mean2 / sums.good - mean * mean;
  const double frame_variance = sequence.frame_mean_variance_counts2();
  // variance of a pixel = noise + unevenness * flicker, variance of a frame = flicker + noise / n.
  const double unevenness = sums.light2 * sums.good / squared(sums.light);
  const double noise =
      (sums.variance / sums.good - unevenness * frame_variance) / (1.0 - unevenness / sums.good);
  const double flicker = std::max(0.0, frame_variance - noise / sums.good);
  const double quiet = without_rounding_counts2(noise);
  const double still = still_rounding_counts2(noise);

  LightLevel out;
  out.frames = sequence.frames();
  out.flicker_counts = std::sqrt(flicker);
  out.clipped_share = sums.clipped / (sums.good * frames);
  const double cut_off = dark != nullptr ? 0.0 : out.clipped_share;
  // Few frames may agree by chance; better than the noise of their pixels allows they cannot.
  const double mean_variance = std::max(frame_variance, noise / sums.good) / frames;
  out.point.mean_counts = {
      sequence.frame_mean_counts() + mean,
      root_sum_of_squares({std::sqrt(mean_variance), std::sqrt(still / sums.good),
                           rounding_of_mean_counts(quiet, spread),
                           cut_off * std::sqrt(noise + spread)})};
  out.point.variance_counts2 = {
      noise, root_sum_of_squares({scatter_counts2(sums, frames, noise, flicker), still,
                                  rounding_of_variance_counts2(quiet, spread), cut_off * noise})};
  return out;
}

double without_rounding_counts2(double variance_counts2) {
  return std::max(0.0, variance_counts2 - kQuantisationVariance_counts2);
}

double still_rounding_counts2(double temporal_variance_counts2) {
  return std::exp(-4.0 * kPi2 * without_rounding_counts2(temporal_variance_counts2)) / (2.0 * kPi2);
}

}  // namespace lsv
