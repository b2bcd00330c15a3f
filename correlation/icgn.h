// SPDX-License-Identifier: BSD-3-Clause
// Inverse-compositional Gauss-Newton refinement of a shift (Baker and Matthews, "Lucas-Kanade 20
// Years On", IJCV 2004) with gain and offset as nuisance parameters: the later frame, interpolated
// at the shift, is compared with the reference, whose gradients were computed once.
//
// The covariance is taken from the residual. Its part that does not correlate from row to row is
// camera noise; the part that does has changed with the pattern (boiling) and counts for more,
// because neighbouring pixels agree on it:
//   cov = H^-1 h (v_n + k (pi/2) sqrt|W| v_b) / gain^2 + (m W^2)^2
// with H the normal matrix of the gradients less what noise adds to it, v_n the noise variance of
// both frames, v_b the variance of the boiling, W the shape of the correlation peak and h the
// excess of the residual where gradients are steep (shot noise, speckle that boils as it shines).
// The second term is that of shift_error() in quality.h; k, and m for what interpolation leaves,
// are measured with the simulator.
#pragma once

#include "correlation/aligned_buffer.h"
#include "correlation/hole_mask.h"
#include "correlation/lag_window.h"
#include "correlation/peak.h"
#include "correlation/track_frame.h"
#include "lsv/core/shift.h"

namespace lsv {

struct Refined {
  bool converged = false;
  double dx_px = kUnknown;
  double dy_px = kUnknown;
  double zncc = kUnknown;           // at the sub-pixel shift
  ShiftCovariance noise_cov;        // of camera noise, reference and later frame in equal parts
  ShiftCovariance boiling_cov;      // of the change of the pattern between the frames
  double boiling_ratio = kUnknown;  // variance of the boiling / variance of the pattern
};

/// One object per thread; owns its scratch memory, allocates at construction only.
class IcGn {
 public:
  IcGn() = default;
  explicit IcGn(const FrameFormat& format);

  /// Pixels of the sensor that show nothing, row-major; see HoleMask.
  void set_holes(const std::vector<std::uint8_t>& is_hole) { holes_.set(is_hole); }

  /// `peak` must be `ok`: the start, and the shape that the covariance needs. `window` is the one
  /// it was found in.
  Refined refine(const TrackReference& reference, const TrackFrame& later, const Peak& peak,
                 const LagWindow& window);

 private:
  /// Sums over the reference, kept while region and reference stay the same.
  struct Cache {
    std::uint64_t reference = 0;
    kernels::Region region;
    kernels::ReferenceSums sums;
  };
  struct Fit;
  /// What is compared at one whole shift.
  struct Compared {
    kernels::Region region;
    kernels::ReferencePlanes planes;
    kernels::ReferenceSums sums;
  };

  kernels::Region region_of(int dx_px, int dy_px) const;
  Compared compared_at(const TrackReference& reference, int dx_px, int dy_px, bool skip_clipped);
  bool iterate(const TrackReference& reference, const TrackFrame& later, bool skip_clipped,
               Fit& fit);

  FrameFormat format_;
  AlignedBuffer<float> scratch_;
  Cache caches_[2];  // all pixels, and without those near clipped ones
  HoleMask holes_;
  AlignedBuffer<float> without_holes_;  // values of the reference
};

}  // namespace lsv
