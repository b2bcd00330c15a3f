// SPDX-License-Identifier: BSD-3-Clause
// The tracking engine: the shift of a later frame against a reference whose place is nearly known.
//   guess -> climb the ZNCC of whole lags -> 2-D Gaussian through nine lags -> IC-GN refinement
// It looks a few px around the guess only: a shift that it reports is the nearest maximum of the
// ZNCC, and whether that is the right one is for the gates to judge.
#pragma once

#include "correlation/icgn.h"
#include "correlation/lag_window.h"
#include "correlation/row_probe.h"
#include "correlation/track_frame.h"
#include "lsv/core/shift.h"

namespace lsv {

/// Whole lags and a peak fit, or these and Gauss-Newton.
enum class Refinement { none, icgn };

struct TrackedShift {
  /// `peak_at_border`: no maximum near the guess; `flat_peak`: none with a shape. Quality: zncc and
  /// zncc_sigmas only, nothing else of the plane was looked at.
  Shift shift{};
  /// The parts of shift.cov, see icgn.h. Without refinement all is noise.
  ShiftCovariance noise_cov{};
  ShiftCovariance boiling_cov{};
  double boiling_ratio = 0.0;
  /// Whether IC-GN converged. Two such shifts against the same reference share its noise, half of
  /// noise_cov each; without refinement the error of the peak fit is most of it.
  bool refined = false;
  /// Whether the rows of the later frame move as one.
  RowAgreement rows{};
};

/// One object per thread; allocates at construction only.
class Tracker {
 public:
  Tracker(const FrameFormat& format, Refinement refinement, double noise_sd_counts);

  /// Pixels of the sensor that show nothing, row-major, not 0 where they are. IC-GN leaves them
  /// out; rows that have some are not alike anyway, so with holes no rows are compared.
  void set_holes(const std::vector<std::uint8_t>& is_hole);

  /// Makes `reference` from `frame`, with weights for the speckle size found in it.
  void build(const TrackFrame& frame, TrackReference& reference) const;

  /// `reference` was built from `earlier`. The guess is where the pattern should have moved.
  TrackedShift measure(const TrackFrame& earlier, const TrackReference& reference,
                       const TrackFrame& later, double guess_dx_px, double guess_dy_px);

  /// The same rows, for a shift that was found otherwise.
  RowAgreement rows_at(const TrackFrame& earlier, const TrackFrame& later, double dx_px,
                       double dy_px);

 private:
  FrameFormat format_;
  Refinement refinement_;
  double noise_sd_counts_;
  IcGn icgn_;
  RowProbe row_probe_;
  bool has_holes_ = false;
};

}  // namespace lsv
