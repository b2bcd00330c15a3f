// SPDX-License-Identifier: BSD-3-Clause
// Engines that turn two frames into a correlation plane over the lags. All engines share one
// interface and one sign: lag (dx, dy) compares earlier(x, y) with later(x + dx, y + dy), so the
// peak stands at the motion of the pattern.
//
//   zncc    plane = ZNCC over the exact overlap at each lag, in [-1, 1]; no bias towards zero
//           shift. By FFT, with the sums of Lewis, "Fast Normalized Cross-Correlation" (1995).
//   cross   plane = sum of the centred products / energy of the full frames (zero padded, not
//           circular). Falls off with the overlap: reads slightly short.
//   phase   plane = inverse transform of the whitened cross spectrum of Hann-windowed frames
//           (Kuglin and Hines 1975).
//   direct  the zncc plane by its definition, lag by lag in double: the reference. Slow.
#pragma once

#include <memory>
#include <vector>

#include "correlation/prepared_frame.h"
#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/core/shift.h"

namespace lsv {

/// (2 max_dy + 1) rows of (2 max_dx + 1) values; row = dy, column = dx, both from -max.
struct CorrelationPlane {
  LagRange lags;
  AlignedBuffer<float> values;

  int width() const { return 2 * lags.max_dx_px + 1; }
  int height() const { return 2 * lags.max_dy_px + 1; }
  const float* row(int dy_px) const {
    return values.data() + static_cast<std::ptrdiff_t>(dy_px + lags.max_dy_px) * width();
  }
  float at(int dx_px, int dy_px) const { return row(dy_px)[dx_px + lags.max_dx_px]; }
};

/// Owns plans and scratch memory made at construction; prepare() and correlate() do not
/// allocate. One object per thread.
class Correlator {
 public:
  virtual ~Correlator() = default;

  const FrameFormat& format() const { return format_; }
  const LagRange& lags() const { return lags_; }

  CorrelationPlane make_plane() const;
  virtual PreparedFrame make_prepared_frame() const = 0;

  /// `frame` must have format().
  virtual void prepare(const FrameView& frame, PreparedFrame& out) = 0;
  /// Both frames must have been prepared by this engine.
  virtual void correlate(const PreparedFrame& earlier, const PreparedFrame& later,
                         CorrelationPlane& plane) = 0;

 protected:
  Correlator(const FrameFormat& format, const LagRange& lags) : format_(format), lags_(lags) {}

 private:
  FrameFormat format_;
  LagRange lags_;
};

/// The lags that `config` means for frames of this size. invalid_argument when the range leaves
/// less than 8 px of overlap, or the frame is smaller than 16 px along an axis.
Result<LagRange> resolve_lags(const CorrelationConfig& config, const FrameFormat& format);

Result<std::unique_ptr<Correlator>> make_correlator(const CorrelationConfig& config,
                                                    const FrameFormat& format);

/// The ZNCC of two frames at one whole-pixel lag over their exact overlap, in double, by
/// definition; 0 where a region is constant. |dx_px| < width, |dy_px| < height.
double zncc_at(const PreparedFrame& earlier, const PreparedFrame& later, int dx_px, int dy_px);

}  // namespace lsv
