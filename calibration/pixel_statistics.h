// SPDX-License-Identifier: BSD-3-Clause
// What a sequence of frames at one level of light says about each pixel: mean and variance over
// time, in one pass (B. P. Welford, Technometrics 4 (1962) 419), in double precision.
// Allocates at creation, 24 bytes a pixel; add() allocates nothing. One object per thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"

namespace lsv {

class PixelStatistics {
 public:
  /// invalid_argument when the format is impossible or memory is short.
  static Result<PixelStatistics> create(const FrameFormat& format);

  /// invalid_argument when the frame is of another format; it is then ignored.
  Result<void> add(const FrameView& frame);

  const FrameFormat& format() const { return format_; }
  std::int64_t frames() const { return frames_; }
  std::size_t pixels() const { return mean_.size(); }

  // Of one pixel, row-major index.
  double mean_counts(std::size_t i) const { return mean_[i]; }
  /// Unbiased; NaN below two frames.
  double variance_counts2(std::size_t i) const {
    return squares_[i] / static_cast<double>(frames_ - 1);
  }
  std::uint32_t times_zero(std::size_t i) const { return zeros_[i]; }
  std::uint32_t times_full(std::size_t i) const { return full_[i]; }  // at full scale

  // Of the mean over all pixels of each frame: what all pixels share.
  double frame_mean_counts() const { return frame_mean_; }
  /// Unbiased; NaN below two frames.
  double frame_mean_variance_counts2() const {
    return frame_squares_ / static_cast<double>(frames_ - 1);
  }

 private:
  explicit PixelStatistics(const FrameFormat& format);
  template <typename Pixel>
  double accumulate(const FrameView& frame);

  FrameFormat format_;
  std::int64_t frames_ = 0;
  std::vector<double> mean_;
  std::vector<double> squares_;  // sum of squared deviations from the mean
  std::vector<std::uint32_t> zeros_;
  std::vector<std::uint32_t> full_;
  double frame_mean_ = 0.0;
  double frame_squares_ = 0.0;
};

}  // namespace lsv
