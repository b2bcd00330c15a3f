// SPDX-License-Identifier: BSD-3-Clause
// Everything about one frame that a correlation needs and that does not depend on the other frame
// of the pair: computed once per frame, used as the later and then as the earlier of two pairs.
#pragma once

#include <complex>
#include <span>

#include "correlation/aligned_buffer.h"
#include "lsv/core/frame.h"
#include "lsv/core/shift.h"

namespace lsv {

/// Grey-value statistics over the whole frame.
struct FrameStats {
  double mean_counts = 0.0;
  double sd_counts = 0.0;  // spread over the pixels, pattern and noise together
  double saturated_fraction = 0.0;
};

/// For the region of a frame that overlaps its partner at each lag. At lag (dx, dy) the later
/// frame keeps columns [dx, W) if dx >= 0, else [0, W + dx), rows alike; the earlier frame keeps
/// the region of lag (-dx, -dy). Entries are in plane order (see CorrelationPlane), S and E being
/// the sums of the centred pixels and of their squares over the n pixels of the region.
struct OverlapTables {
  AlignedBuffer<float> mean_root;  // S / sqrt(n)
  AlignedBuffer<float> inv_norm;   // 1 / sqrt(E - S^2 / n); 0 where the region is constant
};

struct PreparedFrame {
  FrameFormat format;
  FrameStats stats;
  int stride_px = 0;                            // of `centred`
  AlignedBuffer<float> centred;                 // pixel - mean, zero beyond the width
  AlignedBuffer<std::complex<float>> spectrum;  // empty for engines without an FFT
  OverlapTables overlap;                        // empty for engines that do not need it

  const float* centred_row(int y_px) const {
    return centred.data() + static_cast<std::ptrdiff_t>(y_px) * stride_px;
  }
};

/// A region whose variance is below this holds no pattern; the fraction keeps single-precision
/// correlation sums, whose error goes with the energy of the whole frame, from being divided by
/// next to nothing.
inline constexpr double kConstantVariance_counts2 = 1e-6;
inline constexpr double kMinEnergyFraction = 1e-5;

/// True when both frames hold exactly the same pixels.
bool identical_pixels(const PreparedFrame& a, const PreparedFrame& b);

/// Fills `stats` and the frame area of `centred`; the rest of `centred` stays zero.
/// `column_sums` and `column_squares` (width each) receive the sums down each column.
void centre_frame(const FrameView& frame, PreparedFrame& out, std::span<double> column_sums,
                  std::span<double> column_squares);

/// Computes OverlapTables for frames of one size. Owns its scratch memory.
class OverlapSums {
 public:
  OverlapSums(const FrameFormat& format, const LagRange& lags);

  OverlapTables make_tables() const;

  /// Fills `out.overlap` from `out.centred`; the sums down the columns are over all rows.
  void fill(std::span<const double> column_sums, std::span<const double> column_squares,
            PreparedFrame& out);

 private:
  void fill_lags();
  void fill_row(int dy_px, PreparedFrame& out);

  FrameFormat format_;
  LagRange lags_;
  // Sums over the rows that are kept, down each column, then along the columns for each dx.
  AlignedBuffer<double> column_sums_;
  AlignedBuffer<double> column_squares_;
  AlignedBuffer<double> lag_sums_;
  AlignedBuffer<double> lag_squares_;
  AlignedBuffer<double> inv_root_cols_;  // 1 / sqrt(columns kept), for each dx
  double full_spread_counts2_ = 0.0;     // of the frame at hand
};

}  // namespace lsv
