// SPDX-License-Identifier: BSD-3-Clause
// The integer stage of the tracker: the ZNCC of nine lags around a guess, exact in integers, and
// the climb to the lag where the middle one is the highest. Every lag is normalised over its own
// region of the later frame; the region of the earlier one is common to the nine, so that a window
// costs nothing at lags where no pixel of it would overlap.
#pragma once

#include <array>

#include "correlation/track_frame.h"

namespace lsv {

struct LagWindow {
  bool found = false;  // the middle lag is no lower than its neighbours
  int dx_px = 0;       // of the middle lag
  int dy_px = 0;
  std::array<double, 9> zncc{};  // row by row; 0 where a region is constant
  double overlap_px = 0.0;       // pixels in each region
  // Of the middle lag: later pixel = gain * earlier pixel + offset, by spread and mean.
  double gain = 1.0;
  double offset_counts = 0.0;
  double earlier_mean_counts = 0.0;
};

/// The window around one lag, not climbed. False when less than kMinOverlap_px columns or rows
/// would overlap at one of the nine lags; `out` is then unchanged.
bool lag_window_at(const TrackFrame& earlier, const TrackFrame& later, int dx_px, int dy_px,
                   LagWindow& out);

/// Climbs from the guess. Not found: the climb left the frame or took more than kMaxClimbs
/// windows.
LagWindow climb(const TrackFrame& earlier, const TrackFrame& later, int guess_dx_px,
                int guess_dy_px);

inline constexpr int kMinOverlap_px = 12;
inline constexpr int kMaxClimbs = 12;

}  // namespace lsv
