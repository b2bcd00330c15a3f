// SPDX-License-Identifier: BSD-3-Clause
// Which window, frame rate and exposure give the smallest velocity error at a given speed: tries
// square windows and series of rates and exposures with noise_model.h.
//
// Rates compare only over equal times, so what is minimised is the sigma of the mean velocity over
// 1 / update_hz: of one frame where the rate is the update rate, of several in a row where it is
// higher. Light and blur grow with the exposure; the correlation from frame to frame falls with the
// time between frames. Of choices that are equally good within 5 % the one with the fewest pixels
// per second is taken.
//
// Pure functions; they allocate.
#pragma once

#include <optional>
#include <vector>

#include "calibration/noise_model.h"
#include "calibration/speckle_geometry.h"

namespace lsv {

/// The fastest that a camera reads a window of this side. Between two windows the smaller rate
/// counts; windows beyond the largest are not available.
struct CameraRate {
  int window_px = 0;
  double rate_hz = 0.0;
};

struct ChoiceQuestion {
  /// What is known: light at `exposure_s`, correlation at `scale.rate_hz` and `speed_m_s`. Its
  /// window, shift and blur are not used.
  NoiseConditions known;
  SensorScale scale;        // along the motion
  double exposure_s = 0.0;  // > 0
  double speed_m_s = 0.0;   // the highest to be measured, > 0
  double update_hz = 100.0;
  std::vector<int> windows_px = {64, 96, 128, 192, 256, 384, 512};
  /// Rising windows. Empty: every window at scale.rate_hz or slower.
  std::vector<CameraRate> camera_rates;
  /// Time of one push for a window of one pixel, s; unknown: the processor is no limit.
  double push_s_per_px = kUnknown;
};

struct Choice {
  int window_px = 0;
  double rate_hz = kUnknown;
  double exposure_s = kUnknown;
  double shift_px = kUnknown;  // per frame
  double blur_px = kUnknown;
  double mean_signal_counts = kUnknown;
  double zncc_sigmas = kUnknown;
  NoiseParts parts;                    // of one shift along the motion
  double frame_sigma_m_s = kUnknown;   // velocity of one frame in tracking
  double update_sigma_m_s = kUnknown;  // mean velocity over 1 / update_hz
  double distance_sigma_m = kUnknown;  // after 1 m, random errors only; grows with the root
  double push_load_ratio = kUnknown;   // of one processor
};

/// What a choice does not keep.
enum class ChoiceLimit {
  none,
  camera,     // the camera does not read this window as often
  update,     // slower than the update rate
  speed,      // a shift per frame of more than a quarter of the window
  exposure,   // longer than the time between frames
  blur,       // of more than a speckle during the exposure
  processor,  // more than half of one processor
  noise,      // not predicted (Attempt::range), or too near to the gate
};
std::string_view advice(ChoiceLimit limit);

// What a choice must keep.
inline constexpr double kLargestBlur_ratio = 1.0;  // of the speckle size
inline constexpr double kZnccSigmasMargin = 2.0;   // times the gate
inline constexpr double kLargestPushLoad_ratio = 0.5;

struct Attempt {
  std::optional<Choice> choice;
  ChoiceLimit limit = ChoiceLimit::none;
  NoiseRange range = NoiseRange::inside;
};

/// The question at one window, rate and exposure.
Attempt evaluate(const ChoiceQuestion& question, int window_px, double rate_hz, double exposure_s);

struct WindowChoice {
  int window_px = 0;
  std::optional<Choice> best;
  ChoiceLimit limit = ChoiceLimit::none;  // why there is none
};

struct Recommendation {
  std::vector<WindowChoice> windows;
  std::optional<Choice> best;
};

Recommendation recommend(const ChoiceQuestion& question);

}  // namespace lsv
