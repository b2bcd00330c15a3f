// SPDX-License-Identifier: BSD-3-Clause
// The OpenCV methods that lsv is compared with, used as well as their documentation allows: float
// copies and the Hann window are made once, outside the timing. One thread.
#pragma once

#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

#include "bench/frames.h"

namespace lsv::bench {

/// The frames of `loop` as float32 images, in the order 0 .. kFrames - 1.
class FloatFrames {
 public:
  explicit FloatFrames(const cli::SimulatedLoop& loop);
  const cv::Mat& frame(std::int64_t k) const;

 private:
  std::vector<cv::Mat> images_;
};

/// cv::phaseCorrelate.
class PhaseCorrelate {
 public:
  /// `windowed`: with the Hann window that its documentation recommends.
  PhaseCorrelate(int side_px, bool windowed);
  Answer shift(const cv::Mat& earlier, const cv::Mat& later) const;

  /// Whitening and a 5 x 5 centroid leave 0.1 px rms at 128 px; smaller frames are worse.
  static constexpr double kTolerance_px = 0.6;

 private:
  cv::Mat window_;  // empty: none
};

/// cv::matchTemplate (TM_CCOEFF_NORMED): the centre of the earlier frame searched in the later one,
/// and a 3-point Gaussian per axis around the highest value.
class TemplateMatch {
 public:
  /// Lags of +-32 px where that leaves a template of half the frame or more, else less.
  explicit TemplateMatch(int side_px);
  Answer shift(const cv::Mat& earlier, const cv::Mat& later);

  int range_px() const { return range_px_; }
  int template_px() const { return template_px_; }

  static constexpr double kTolerance_px = 0.15;

 private:
  int range_px_;
  int template_px_;
  cv::Mat scores_;
};

}  // namespace lsv::bench
