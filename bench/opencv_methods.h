// SPDX-License-Identifier: BSD-3-Clause
// The OpenCV methods that lsv is compared with, used to their advantage: float copies and the
// Hann window are made outside the timing.
#pragma once

#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

#include "bench/answers.h"
#include "bench/frames.h"

namespace lsv::bench {

/// The frames of `loop` (8 bit) as OpenCV images. cv::phaseCorrelate wants float32;
/// cv::matchTemplate is faster on 8 bit, where it transforms in single precision.
class OpenCvFrames {
 public:
  explicit OpenCvFrames(const cli::SimulatedLoop& loop);
  const cv::Mat& bytes(std::int64_t k) const;
  const cv::Mat& floats(std::int64_t k) const;

 private:
  std::vector<cv::Mat> bytes_;
  std::vector<cv::Mat> floats_;
};

/// cv::phaseCorrelate. With a window it overwrites its inputs (OpenCV 4.6, sizes that need no
/// padding), so it works on copies, which the caller makes outside the timing.
class PhaseCorrelate {
 public:
  /// `windowed`: with the Hann window that its documentation recommends.
  PhaseCorrelate(int side_px, bool windowed);
  void load(const cv::Mat& earlier, const cv::Mat& later);
  Answer shift();

  /// Whitening and a 5 x 5 centroid leave 0.1 px rms at 128 px; smaller frames are worse.
  static constexpr double kTolerance_px = 0.6;

 private:
  cv::Mat window_;  // empty: none
  cv::Mat earlier_;
  cv::Mat later_;
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
