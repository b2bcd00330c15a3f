// SPDX-License-Identifier: BSD-3-Clause
#include "correlation/correlator.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "correlation/engines.h"

namespace lsv {
namespace {

constexpr int kSourceRange_px = 32;  // search range of the Masuku thesis
constexpr int kMinOverlap_px = 8;
constexpr int kMinSide_px = 16;

}  // namespace

CorrelationPlane Correlator::make_plane() const {
  const auto size = static_cast<std::size_t>(2 * lags_.max_dx_px + 1) *
                    static_cast<std::size_t>(2 * lags_.max_dy_px + 1);
  return {.lags = lags_, .values = AlignedBuffer<float>(size)};
}

Result<LagRange> resolve_lags(const CorrelationConfig& config, const FrameFormat& format) {
  const int width = format.width_px;
  const int height = format.height_px;
  if (std::min(width, height) < kMinSide_px) {
    return Error{ErrorCode::invalid_argument,
                 "the frame is " + std::to_string(width) + " x " + std::to_string(height) +
                     " px but correlation needs at least " + std::to_string(kMinSide_px) +
                     " px along each axis"};
  }
  if (!config.max_shift_px)
    return LagRange{std::min(kSourceRange_px, width / 2), std::min(kSourceRange_px, height / 2)};
  const int range = *config.max_shift_px;
  if (range > std::min(width, height) - kMinOverlap_px) {
    return Error{ErrorCode::invalid_argument,
                 "max_shift_px is " + std::to_string(range) + " but frames of " +
                     std::to_string(width) + " x " + std::to_string(height) + " px allow at most " +
                     std::to_string(std::min(width, height) - kMinOverlap_px)};
  }
  return LagRange{range, range};
}

Result<std::unique_ptr<Correlator>> make_correlator(const CorrelationConfig& config,
                                                    const FrameFormat& format) {
  const Result<LagRange> lags = resolve_lags(config, format);
  if (!lags) return lags.error();
  if (config.engine == Engine::direct) return make_direct_correlator(format, lags.value());
  return make_fft_correlator(config.engine, format, lags.value());
}

double zncc_at(const PreparedFrame& earlier, const PreparedFrame& later, int dx_px, int dy_px) {
  const int width = earlier.format.width_px - std::abs(dx_px);
  const int height = earlier.format.height_px - std::abs(dy_px);
  const int x_earlier = std::max(0, -dx_px);
  const int y_earlier = std::max(0, -dy_px);
  double sum_a = 0.0, sum_b = 0.0, sum_aa = 0.0, sum_bb = 0.0, sum_ab = 0.0;
  for (int y = 0; y < height; ++y) {
    const float* const a = earlier.centred_row(y_earlier + y) + x_earlier;
    const float* const b = later.centred_row(y_earlier + dy_px + y) + x_earlier + dx_px;
    for (int x = 0; x < width; ++x) {
      const double va = a[x];
      const double vb = b[x];
      sum_a += va;
      sum_b += vb;
      sum_aa += va * va;
      sum_bb += vb * vb;
      sum_ab += va * vb;
    }
  }
  const double n = static_cast<double>(width) * height;
  const double spread_a = sum_aa - sum_a * sum_a / n;
  const double spread_b = sum_bb - sum_b * sum_b / n;
  if (std::min(spread_a, spread_b) <= n * kConstantVariance_counts2) return 0.0;
  return (sum_ab - sum_a * sum_b / n) / std::sqrt(spread_a * spread_b);
}

}  // namespace lsv
