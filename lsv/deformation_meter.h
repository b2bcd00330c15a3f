// SPDX-License-Identifier: BSD-3-Clause
// In-plane rotation and expansion from the shifts of four windows in the corners of what two
// frames have in common: the similarity transform that fits them best (least squares, weighted by
// their sigmas; if the windows disagree by more than that, the sigmas of the result grow with it).
// Good up to a few degrees or per cent, where the windows still correlate.
#pragma once

#include <array>

#include "correlation/tracker.h"
#include "lsv/core/deformation.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"

namespace lsv {

/// Owns its memory, allocates at construction only; one object per thread.
class DeformationMeter {
 public:
  /// invalid_argument when a side of the frames is below kMinSide_px.
  static Result<DeformationMeter> create(const FrameFormat& format, double noise_sd_counts);

  /// The frames show the same ground, shifted by about (dx_px, dy_px).
  Deformation measure(const TrackFrame& earlier, const TrackFrame& later, double dx_px,
                      double dy_px);

  static constexpr int kMinSide_px = 64;

 private:
  DeformationMeter(const FrameFormat& format, double noise_sd_counts);

  struct Window {
    double x_px, y_px;  // centre in the earlier frame
    double dx_px, dy_px;
    double weight_1_px2;  // 1 / variance per axis; 0: not measured
  };
  Window measure_window(const TrackFrame& earlier, const TrackFrame& later, const Roi& at,
                        int whole_dx_px, int whole_dy_px);

  FrameFormat format_;
  FrameFormat window_format_;
  Tracker tracker_;
  TrackFrame earlier_;
  TrackFrame later_;
  TrackReference reference_;
};

}  // namespace lsv
