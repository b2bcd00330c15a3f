// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/icgn.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "correlation/quality.h"

namespace lsv {
namespace {

constexpr int kMaxIterations = 6;
// Gauss-Newton: a step leaves an error hundreds of times smaller than itself. Done when that is
// well below the error of the shift; a last step between these bounds always will do.
constexpr double kConvergedSigmas = 30.0;
constexpr double kConvergedLowest_px = 0.001;
constexpr double kConvergedHighest_px = 0.01;
// The correlation peak was found within a fraction of this; further off, something else was found.
constexpr double kMaxCorrection_px = 1.0;
// The region of the reference changes in steps, so that its sums serve many frames.
constexpr int kRegionStep_px = 6;
constexpr int kMinRegion_px = 8;
// From this share of boiling on, the pixels near clipped ones do more good than harm.
constexpr double kBoilingNotClipping = 4e-4;
constexpr double kRoundingVariance_counts2 = 1.0 / 12.0;
// What interpolation and clipping leave on frames without noise, at 128 x 128 px; measured with the
// simulator from 1.2 to 15 px speckle. It grows with the fourth power of the width of the peak up
// to 6 px speckle, in proportion from there on; below 3 px speckle undersampling takes over.
constexpr double kModelErrorPixels = 128.0 * 128.0;
// However many more pixels there are: weights have 15 bits.
constexpr double kSmallestError_px = 5e-5;
constexpr double kModelError_1_px3 = 3.4e-6;
constexpr double kCoarsePeak_px2 = 6.5;
constexpr double kUndersampling_px = 1e-3;
constexpr double kUndersampledSpeckle_px = 2.1;  // where it is that large; e times less for every
constexpr double kUndersamplingDecay_px = 0.22;
// Boiling that is less than this many standard deviations of its estimate is taken for noise.
constexpr double kBoilingFromSigmas = 0.5;
// Boiling of speckle intensity against that of a Gaussian pattern of the same autocovariance, while
// little has boiled. What of the residual goes with the brightness of the pattern adds the excess
// over 1; what is new speckle altogether adds none.
constexpr double kBoilingExcess = 0.46;

struct Matrix2 {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  double det() const { return xx * yy - xy * xy; }
};

/// Kernel sums: noise gain at lags 0 and 1, for independent pixels.
struct NoiseGain {
  double lag0 = 0.0, lag1 = 0.0;
};
NoiseGain noise_gain(const KernelWeights& weights) {
  NoiseGain out;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    out.lag0 += static_cast<double>(weights[i]) * weights[i];
    if (i > 0) out.lag1 += static_cast<double>(weights[i]) * weights[i - 1];
  }
  return out;
}

/// The largest weight takes what rounding the others has left, so that the sum stays 1.
kernels::FixedWeights fixed_weights(const KernelWeights& weights) {
  kernels::FixedWeights out{};
  const auto largest =
      static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
  int rest = static_cast<int>(kernels::kFixedOne);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (i == largest) continue;
    out[i] = static_cast<std::int16_t>(std::lround(weights[i] * kernels::kFixedOne));
    rest -= out[i];
  }
  out[largest] = static_cast<std::int16_t>(std::min(rest, 32767));
  return out;
}

/// Circular Gaussian fields that correlate to c in intensity: given the earlier intensity I, the
/// later one has the variance 2 c (1 - c) I <I> + (1 - c)^2 <I>^2 (Goodman), of which the first
/// part is the share 2 c / (1 + c).
double boiling_factor(double boiling_ratio) {
  const double c = 1.0 / std::sqrt(1.0 + boiling_ratio);
  return 1.0 + kBoilingExcess * 2.0 * c / (1.0 + c);
}

double derivative_noise_gain(const SpeckleKernel& kernel) {
  double out = 0.0;
  for (const float d : kernel.derivative_1_px()) out += 2.0 * static_cast<double>(d) * d;
  return out;
}

/// Autocorrelation of the pattern one row away, from the curvature of the correlation peak.
double row_correlation(const PeakShape& w) {
  const double det = w.xx_px2 * w.yy_px2 - w.xy_px2 * w.xy_px2;
  return std::exp(-0.5 * w.xx_px2 / det);
}

int round_up(int value, int step) { return (value + step - 1) / step * step; }

}  // namespace

/// The state of one refinement: shift and grey-value map, and what the last pass measured.
struct IcGn::Fit {
  double dx_px = 0.0, dy_px = 0.0;
  double gain = 1.0, offset_counts = 0.0;
  double step_px = 0.0;
  double sigma_px = 0.0;  // roughly, of the shift
  kernels::ReferenceSums reference{};
  kernels::ResidualSums residual{};
  NoiseGain noise_x{}, noise_y{};
  Matrix2 normal{};       // of the gradients, gain and offset projected out
  double spread = 0.0;    // of the reference over the region
  double sum_left = 0.0;  // of the squared residuals, once fitted
};

IcGn::IcGn(const FrameFormat& format)
    : format_(format),
      scratch_(kernels::residual_scratch_size(format.width_px)),
      holes_(format),
      without_holes_(padded_size(format)) {}

kernels::Region IcGn::region_of(int dx_px, int dy_px) const {
  const auto margins = [](int shift_px) {
    struct {
      int before, after;
    } out;
    const auto margin = [](int needed_px) {
      return kGradientReach_px +
             round_up(std::max(0, needed_px - kGradientReach_px), kRegionStep_px);
    };
    out.before = margin(kKernelLeft_px - shift_px);
    out.after = margin(kKernelRight_px + shift_px);
    return out;
  };
  const auto x = margins(dx_px);
  const auto y = margins(dy_px);
  return {x.before, y.before, format_.width_px - x.before - x.after,
          format_.height_px - y.before - y.after};
}

IcGn::Compared IcGn::compared_at(const TrackReference& reference, int dx_px, int dy_px,
                                 bool skip_clipped) {
  Compared out{
      .region = region_of(dx_px, dy_px), .planes = reference.planes(skip_clipped), .sums = {}};
  if (out.region.width_px < kMinRegion_px || out.region.height_px < kMinRegion_px) return out;
  if (!holes_.empty()) {
    const kernels::Plane<float> values{without_holes_.data() + kernels::kPadding,
                                       out.planes.value.stride};
    holes_.apply(out.planes.value, out.region, dx_px, dy_px, values);
    out.planes.value = {values.data, values.stride};
    out.sums = kernels::reference_sums(out.planes, out.region, scratch_.data());
    return out;
  }
  Cache& cache = caches_[skip_clipped ? 1 : 0];
  if (cache.reference != reference.serial() || !(cache.region == out.region)) {
    cache.reference = reference.serial();
    cache.region = out.region;
    cache.sums = kernels::reference_sums(out.planes, out.region, scratch_.data());
  }
  out.sums = cache.sums;
  return out;
}

/// One Gauss-Newton step; false when the equations have no solution or too few pixels are left.
bool IcGn::iterate(const TrackReference& reference, const TrackFrame& later, bool skip_clipped,
                   Fit& fit) {
  const int whole_dx = static_cast<int>(std::floor(fit.dx_px));
  const int whole_dy = static_cast<int>(std::floor(fit.dy_px));
  const Compared compared = compared_at(reference, whole_dx, whole_dy, skip_clipped);
  const kernels::ReferenceSums& s = compared.sums;
  if (!(s.n > 0.5 * kMinRegion_px * kMinRegion_px)) return false;

  const KernelWeights weights_x = reference.kernel_x().weights(fit.dx_px - whole_dx);
  const KernelWeights weights_y = reference.kernel_y().weights(fit.dy_px - whole_dy);
  const kernels::Warp warp{
      .whole_dx_px = whole_dx,
      .whole_dy_px = whole_dy,
      .bit_depth = format_.bit_depth,
      .weights_x = fixed_weights(weights_x),
      .weights_y = fixed_weights(weights_y),
      .six_taps = reference.kernel_x().has_six_taps() && reference.kernel_y().has_six_taps(),
      .gain = static_cast<float>(fit.gain),
      .offset_counts = static_cast<float>(fit.offset_counts)};
  const kernels::ResidualSums r =
      format_.type == PixelType::mono8
          ? kernels::residual_sums(compared.planes, later.pixels<std::uint8_t>(), compared.region,
                                   warp, scratch_.data())
          : kernels::residual_sums(compared.planes, later.pixels<std::uint16_t>(), compared.region,
                                   warp, scratch_.data());

  // Gain and offset are eliminated first; `projected` is what they explain of a product.
  const double det = s.vv * s.n - s.v * s.v;
  if (!(det > 0.0)) return false;
  const auto projected = [&](double av, double a1, double bv, double b1) {
    return (s.n * av * bv - s.v * (av * b1 + a1 * bv) + s.vv * a1 * b1) / det;
  };
  const Matrix2 normal{.xx = s.xx - projected(s.xv, s.x, s.xv, s.x),
                       .xy = s.xy - projected(s.xv, s.x, s.yv, s.y),
                       .yy = s.yy - projected(s.yv, s.y, s.yv, s.y)};
  const double bx = r.rx - projected(s.xv, s.x, r.rv, r.r);
  const double by = r.ry - projected(s.yv, s.y, r.rv, r.r);
  const double normal_det = normal.det();
  if (!(normal_det > 1e-9 * normal.xx * normal.yy) || !(fit.gain > 0.0)) return false;
  const double cx = (normal.yy * bx - normal.xy * by) / normal_det;
  const double cy = (normal.xx * by - normal.xy * bx) / normal_det;
  const double left_v = r.rv - cx * s.xv - cy * s.yv;
  const double left_1 = r.r - cx * s.x - cy * s.y;
  const double gain_step = (s.n * left_v - s.v * left_1) / det;
  const double offset_step = (s.vv * left_1 - s.v * left_v) / det;

  const double step_x = -cx / fit.gain;
  const double step_y = -cy / fit.gain;
  fit.dx_px += step_x;
  fit.dy_px += step_y;
  fit.gain += gain_step;
  fit.offset_counts += offset_step;
  fit.step_px = std::max(std::abs(step_x), std::abs(step_y));
  fit.reference = s;
  fit.residual = r;
  fit.noise_x = noise_gain(weights_x);
  fit.noise_y = noise_gain(weights_y);
  fit.normal = normal;
  fit.spread = det / s.n;
  fit.sum_left = std::max(0.0, r.rr - cx * r.rx - cy * r.ry - gain_step * r.rv - offset_step * r.r);
  fit.sigma_px = std::sqrt(fit.sum_left / s.n / std::max(normal.xx, normal.yy)) / fit.gain;
  return std::isfinite(fit.dx_px) && std::isfinite(fit.dy_px);
}

namespace {

/// Variance of the residual per pixel, split by its correlation from row to row.
struct ResidualVariance {
  double noise_counts2;  // camera noise of one pixel of the later frame
  double boiling_counts2;
};

}  // namespace

Refined IcGn::refine(const TrackReference& reference, const TrackFrame& later, const Peak& peak,
                     const LagWindow& window) {
  Refined out;
  Fit fit{.dx_px = peak.dx_px, .dy_px = peak.dy_px, .gain = window.gain};
  fit.offset_counts = window.offset_counts + window.gain * reference.mean_counts();
  const double c1 = row_correlation(peak.shape);
  bool skip_clipped = reference.has_clipped_pixels();
  ResidualVariance variance{};
  double pattern_variance = 0.0;
  double noise_gain_2d = 0.0;
  for (int i = 0; i < kMaxIterations; ++i) {
    if (!iterate(reference, later, skip_clipped, fit)) return out;
    if (std::abs(fit.dx_px - peak.dx_px) > kMaxCorrection_px ||
        std::abs(fit.dy_px - peak.dy_px) > kMaxCorrection_px)
      return out;
    const double converged_px =
        std::clamp(kConvergedSigmas * fit.sigma_px, kConvergedLowest_px, kConvergedHighest_px);
    if (fit.step_px > converged_px) continue;

    const kernels::ReferenceSums& s = fit.reference;
    noise_gain_2d = fit.noise_x.lag0 * fit.noise_y.lag0;
    const double noise_lag1 = fit.noise_x.lag0 * fit.noise_y.lag1;
    const double gain2 = fit.gain * fit.gain;
    const double total = fit.sum_left / std::max(1.0, s.n - 4.0);
    // What the step has taken out correlates like the pattern.
    const double explained = (fit.residual.rr - fit.sum_left) / s.n;
    const double lag1 = fit.residual.rr_next_row / std::max(1.0, s.n_next_row) - explained * c1;
    const double lag0_of_noise = gain2 + noise_gain_2d;
    const double denominator = c1 * lag0_of_noise - noise_lag1;
    double noise = total / lag0_of_noise;
    if (denominator > 0.1) {
      // Boiling cannot be negative: without the second term chance alone would look like some.
      const double sigma_of_noise = total / (denominator * std::sqrt(s.n));
      noise = std::clamp((c1 * total - lag1) / denominator + kBoilingFromSigmas * sigma_of_noise,
                         0.0, noise);
    }
    variance = {.noise_counts2 = noise, .boiling_counts2 = total - lag0_of_noise * noise};
    pattern_variance = gain2 * std::max(fit.spread / s.n - noise, 0.05 * fit.spread / s.n);
    out.boiling_ratio = variance.boiling_counts2 / pattern_variance;
    if (skip_clipped && out.boiling_ratio > kBoilingNotClipping) {
      skip_clipped = false;
      continue;
    }
    out.converged = true;
    break;
  }
  if (!out.converged) return out;

  const kernels::ResidualSums& r = fit.residual;
  const double gain2 = fit.gain * fit.gain;
  const double noise_counts2 = std::max(variance.noise_counts2, kRoundingVariance_counts2);
  const double steep = r.few_rr > 0.0 && r.few_g > 0.0
                           ? std::clamp(r.few_rrg * r.few_n / (r.few_rr * r.few_g), 0.8, 4.0)
                           : 1.0;
  // Noise in the gradients lengthens them without making them tell more.
  const double noise_reference = fit.reference.n * noise_counts2 / gain2;
  const auto true_share = [&](double sum, const SpeckleKernel& kernel) {
    return std::clamp(1.0 - noise_reference * derivative_noise_gain(kernel) / sum, 0.1, 1.0);
  };
  const double share_x = true_share(fit.normal.xx, reference.kernel_x());
  const double share_y = true_share(fit.normal.yy, reference.kernel_y());
  const double det = fit.normal.det();
  const Matrix2 inverse{.xx = fit.normal.yy / det / (share_x * share_x),
                        .xy = -fit.normal.xy / det / (share_x * share_y),
                        .yy = fit.normal.xx / det / (share_y * share_y)};
  // The fit of the gain takes the noise of the reference for pattern, and so comes out too small.
  const double true_gain = fit.gain / std::clamp(1.0 - noise_reference / fit.spread, 0.1, 1.0);
  const auto scaled = [&](double variance_counts2) {
    const double factor = steep * variance_counts2 / (true_gain * true_gain);
    return ShiftCovariance{factor * inverse.xx, factor * inverse.xy, factor * inverse.yy};
  };
  out.noise_cov = scaled(noise_counts2 * (gain2 + 1.0));
  const auto model_variance = [&](double width_px2) {
    const double fine_px2 = std::min(width_px2, kCoarsePeak_px2);
    const double coarse_ratio = std::sqrt(std::max(width_px2 / kCoarsePeak_px2, 1.0));
    const double smooth_px = kModelError_1_px3 * fine_px2 * fine_px2 * coarse_ratio;
    const double sharp_px =
        kUndersampling_px *
        std::exp((kUndersampledSpeckle_px - speckle_fwhm_px(width_px2)) / kUndersamplingDecay_px);
    // Undersampling errs alike in many places, so that more pixels help less.
    const double fewer = kModelErrorPixels / fit.reference.n;
    const double floor_share = std::max(0.0, 1.0 - fewer);
    return smooth_px * smooth_px * fewer + sharp_px * sharp_px * std::sqrt(fewer) +
           kSmallestError_px * kSmallestError_px * floor_share;
  };
  out.noise_cov.xx_px2 += model_variance(peak.shape.xx_px2);
  out.noise_cov.yy_px2 += model_variance(peak.shape.yy_px2);
  out.boiling_cov = scaled(boiling_factor(out.boiling_ratio) * std::numbers::pi / 2.0 *
                           peak_width_px2(peak.shape) * variance.boiling_counts2);
  out.dx_px = fit.dx_px;
  out.dy_px = fit.dy_px;
  // Of the later frame at the shift: what the reference explains of its spread.
  const double explained = gain2 * fit.spread;
  out.zncc = std::sqrt(explained / (explained + fit.sum_left));
  return out;
}

}  // namespace lsv
