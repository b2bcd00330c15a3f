// SPDX-License-Identifier: BSD-3-Clause
// Do all rows of the later frame show the same motion? A frame that was put together from several
// exposures (torn, half, striped) correlates well as a whole, and its shift is pulled.
//
// Every third row is compared with the earlier frame at the shift found, its left and its right
// half apart. Each half tells its own shift, by one Gauss-Newton step, and its own correlation.
// What a row is off by shows in both halves; what does not go by rows (camera noise, boiling, dirt,
// interpolation) is independent between them. So the covariance of left and right over the rows is
// that of whole rows alone, and the correlation coefficient r of the two says what is left to
// chance, however large the noise:
//   atanh(r) sqrt(n - 3) is standard normal (Fisher 1915) for n independent pairs.
// Ground that turns or expands, and pixels that are exposed row by row, move linearly from row to
// row and correlate less towards the ends: a straight line, for the correlation a parabola, is
// taken out first.
#pragma once

#include <array>

#include "correlation/lag_window.h"
#include "correlation/peak.h"
#include "correlation/track_frame.h"

namespace lsv {

/// What whole rows have of their own. Zeros where the rows agree so well that nobody needs to know
/// how well, and where too few overlap to tell.
struct RowAgreement {
  double moved_px = 0.0;        // rms of their shifts about that of the frame
  double moved_sigmas = 0.0;    // how far from chance
  double changed = 0.0;         // rms of their ZNCC about that of the frame
  double changed_sigmas = 0.0;  // how far from chance
};

/// Allocates nothing; one object per thread.
class RowProbe {
 public:
  /// `peak` holds the shift, within a px of the lag of `window`, and the shape of the peak.
  RowAgreement measure(const TrackFrame& earlier, const TrackFrame& later, const LagWindow& window,
                       const Peak& peak);

 private:
  static constexpr int kMostRows = 128;
  // A step is at least the height over kMostRows, less than one more is left over per step of 3.
  std::array<kernels::ProbedRow, 4 * kMostRows / 3 + 1> rows_{};
};

}  // namespace lsv
