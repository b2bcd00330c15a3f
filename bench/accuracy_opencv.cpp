// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "bench/accuracy_methods.h"
#include "bench/opencv_methods.h"

namespace lsv::bench {
namespace {

constexpr int kEccIterations = 50;
constexpr double kEccGain = 1e-8;  // of the correlation coefficient, at which it stops
constexpr int kEccBlur_px = 5;     // OpenCV's default

/// Borrows the pixels of `frame`; nothing here writes to them.
cv::Mat image_of(const FrameView& frame) {
  return cv::Mat(frame.height_px(), frame.width_px(), CV_8U,
                 const_cast<std::uint8_t*>(frame.row8(0)),
                 static_cast<std::size_t>(frame.stride_bytes));
}

class PhaseCorrelateMethod : public Method {
 public:
  explicit PhaseCorrelateMethod(int side_px) : method_(side_px, true) {}

  Estimate measure(const FrameView& earlier, const FrameView& later) override {
    image_of(earlier).convertTo(earlier_, CV_32F);
    image_of(later).convertTo(later_, CV_32F);
    method_.load(earlier_, later_);
    return {method_.shift()};
  }

 private:
  PhaseCorrelate method_;
  cv::Mat earlier_;
  cv::Mat later_;
};

/// Scores of the centre of the earlier frame over the later one.
class TemplateScores {
 public:
  TemplateScores(int side_px, int template_px)
      : template_px_(template_px), range_px_((side_px - template_px) / 2) {}

  void find(const FrameView& earlier, const FrameView& later) {
    const cv::Rect centre(range_px_, range_px_, template_px_, template_px_);
    cv::matchTemplate(image_of(later), image_of(earlier)(centre), scores_, cv::TM_CCOEFF_NORMED);
    cv::minMaxLoc(scores_, nullptr, nullptr, nullptr, &top_);
  }

  Answer whole() const {
    return {static_cast<double>(top_.x - range_px_), static_cast<double>(top_.y - range_px_)};
  }
  Answer fitted() const {
    Answer out = whole();
    if (top_.x > 0 && top_.x < scores_.cols - 1) out.dx_px += offset(1, 0);
    if (top_.y > 0 && top_.y < scores_.rows - 1) out.dy_px += offset(0, 1);
    return out;
  }

 private:
  /// Of the maximum of the Gaussian through three scores in a row.
  double offset(int step_x, int step_y) const {
    const double before = scores_.at<float>(top_.y - step_y, top_.x - step_x);
    const double centre = scores_.at<float>(top_.y, top_.x);
    const double after = scores_.at<float>(top_.y + step_y, top_.x + step_x);
    if (std::min({before, centre, after}) <= 0.0) return 0.0;
    const double a = std::log(before);
    const double b = std::log(centre);
    const double c = std::log(after);
    return 0.5 * (a - c) / (a - 2.0 * b + c);
  }

  int template_px_;
  int range_px_;
  cv::Mat scores_;
  cv::Point top_;
};

class MatchTemplateMethod : public Method {
 public:
  explicit MatchTemplateMethod(const Condition& condition)
      : scores_(condition.camera.width_px, condition.template_px) {}

  Estimate measure(const FrameView& earlier, const FrameView& later) override {
    scores_.find(earlier, later);
    return {scores_.fitted()};
  }

 private:
  TemplateScores scores_;
};

class EccMethod : public Method {
 public:
  explicit EccMethod(const Condition& condition)
      : scores_(condition.camera.width_px, condition.template_px) {}

  Estimate measure(const FrameView& earlier, const FrameView& later) override {
    scores_.find(earlier, later);
    const Answer start = scores_.whole();
    cv::Mat warp = (cv::Mat_<float>(2, 3) << 1, 0, start.dx_px, 0, 1, start.dy_px);
    const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kEccIterations,
                                 kEccGain);
    try {
      cv::findTransformECC(image_of(earlier), image_of(later), warp, cv::MOTION_TRANSLATION, until,
                           cv::noArray(), kEccBlur_px);
    } catch (const cv::Exception&) {  // it did not converge
      return {};
    }
    return {{warp.at<float>(0, 2), warp.at<float>(1, 2)}};
  }

 private:
  TemplateScores scores_;
};

}  // namespace

NamedMethod phase_correlate(const Condition& condition) {
  return {"phaseCorrelate", std::make_unique<PhaseCorrelateMethod>(condition.camera.width_px)};
}

std::vector<NamedMethod> opencv_peers(const Condition& condition) {
  std::vector<NamedMethod> out;
  out.push_back(phase_correlate(condition));
  out.push_back({"matchTemplate", std::make_unique<MatchTemplateMethod>(condition)});
  out.push_back({"ECC", std::make_unique<EccMethod>(condition)});
  return out;
}

}  // namespace lsv::bench
