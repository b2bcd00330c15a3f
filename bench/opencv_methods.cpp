// SPDX-License-Identifier: BSD-3-Clause
#include "bench/opencv_methods.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace lsv::bench {
namespace {

cv::Mat to_image(const FrameView& frame) {
  cv::Mat out(frame.height_px(), frame.width_px(), CV_8U);
  for (int y = 0; y < frame.height_px(); ++y)
    std::copy_n(frame.row8(y), frame.width_px(), out.ptr<std::uint8_t>(y));
  return out;
}

/// Offset of the maximum of the Gaussian through three values at -1, 0, 1; 0 at the border of the
/// scores or where the logarithm does not exist.
double gaussian_offset(double before, double centre, double after) {
  if (std::min({before, centre, after}) <= 0.0) return 0.0;
  const double a = std::log(before);
  const double b = std::log(centre);
  const double c = std::log(after);
  return 0.5 * (a - c) / (a - 2.0 * b + c);
}

}  // namespace

OpenCvFrames::OpenCvFrames(const cli::SimulatedLoop& loop) {
  for (int k = 0; k < loop.frame_count(); ++k) {
    bytes_.push_back(to_image(loop.frame(k)));
    bytes_.back().convertTo(floats_.emplace_back(), CV_32F);
  }
}

const cv::Mat& OpenCvFrames::bytes(std::int64_t k) const {
  return bytes_[cli::there_and_back(k, bytes_.size())];
}

const cv::Mat& OpenCvFrames::floats(std::int64_t k) const {
  return floats_[cli::there_and_back(k, floats_.size())];
}

PhaseCorrelate::PhaseCorrelate(int side_px, bool windowed) {
  if (windowed) cv::createHanningWindow(window_, cv::Size(side_px, side_px), CV_32F);
}

void PhaseCorrelate::load(const cv::Mat& earlier, const cv::Mat& later) {
  earlier.copyTo(earlier_);
  later.copyTo(later_);
}

Answer PhaseCorrelate::shift() {
  const cv::Point2d out = cv::phaseCorrelate(earlier_, later_, window_);
  return {out.x, out.y};
}

TemplateMatch::TemplateMatch(int side_px)
    : range_px_(std::min(32, side_px / 4)), template_px_(side_px - 2 * range_px_) {}

Answer TemplateMatch::shift(const cv::Mat& earlier, const cv::Mat& later) {
  const cv::Rect centre(range_px_, range_px_, template_px_, template_px_);
  cv::matchTemplate(later, earlier(centre), scores_, cv::TM_CCOEFF_NORMED);
  cv::Point at;
  cv::minMaxLoc(scores_, nullptr, nullptr, nullptr, &at);
  Answer out{static_cast<double>(at.x - range_px_), static_cast<double>(at.y - range_px_)};
  const double top = scores_.at<float>(at);
  if (at.x > 0 && at.x < scores_.cols - 1)
    out.dx_px +=
        gaussian_offset(scores_.at<float>(at.y, at.x - 1), top, scores_.at<float>(at.y, at.x + 1));
  if (at.y > 0 && at.y < scores_.rows - 1)
    out.dy_px +=
        gaussian_offset(scores_.at<float>(at.y - 1, at.x), top, scores_.at<float>(at.y + 1, at.x));
  return out;
}

}  // namespace lsv::bench
