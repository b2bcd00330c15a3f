// SPDX-License-Identifier: BSD-3-Clause
// What is compared: the presets of lsv and the methods of OpenCV, each from two frames of which
// nothing is known to a shift.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "bench/accuracy_conditions.h"
#include "bench/answers.h"
#include "lsv/core/config.h"
#include "lsv/core/frame.h"

namespace lsv::bench {

/// NaN where the method gives no answer, or no sigma.
struct Estimate {
  Answer shift{kUnknown, kUnknown};
  double sigma_x_px = kUnknown;
  double sigma_y_px = kUnknown;
};

class Method {
 public:
  virtual ~Method() = default;
  virtual Estimate measure(const FrameView& earlier, const FrameView& later) = 0;
};

struct NamedMethod {
  std::string_view name;
  std::unique_ptr<Method> method;
};

/// lsv with the calibration of the camera.
TrackConfig track_config(Preset preset, const sim::SpeckleConfig& camera);

/// precise, fast, classic: ShiftMeter::search.
std::vector<NamedMethod> lsv_methods(const Condition& condition);

/// phaseCorrelate, with a Hann window.
NamedMethod phase_correlate(const Condition& condition);
/// phaseCorrelate; matchTemplate, TM_CCOEFF_NORMED with a 3-point Gaussian along each axis; ECC,
/// translation, started at the whole-pixel answer of matchTemplate.
std::vector<NamedMethod> opencv_peers(const Condition& condition);

}  // namespace lsv::bench
