// SPDX-License-Identifier: BSD-3-Clause
// What sigma to expect of a shift, for a camera and speckle that need not exist yet.
//
// Predicted is ONE shift measured by the preset `precise` between two frames (`lsv shift`; the
// first shift on a keyframe), per axis, as the root of
//   2 v (1 + v D / (2 m^2 g)) (1 + S / N) / (m^2 g N)     noise: the Cramer-Rao bound of the pixels
//                                                         that the fit uses
//   + B^2 (g0 / g) F / N                                  boiling of the pattern
//   + C^2 / N                                             clipped pixels
//   + I0^2 + I^2 / N                                      interpolation
// with
//   v = sd^2 + 1/12 + h m / e              variance of a pixel: camera, rounding, shot noise where
//                                          gradients are steep
//   F = (2 h rho (1 - rho) + (1 - rho)^2) / rho^2
// N pixels that both frames see, m mean signal, e electrons per count, rho intensity correlation
// of the two frames. g (mean square of the gradient, mean light 1; g0 without clipping), h (light
// weighted by it), D, S, B, C, I0 and I belong to a speckle size, a blur and a saturation; they
// come from simulations (noise_table.h) and are interpolated between them, never beyond. Derivation
// and check against simulated frames: docs/noise.md.
//
// Pure functions, any thread. x is the direction of the motion.
#pragma once

#include <limits>
#include <string_view>

#include "lsv/core/shift.h"

namespace lsv {

struct NoiseConditions {
  int width_px = 0;  // of the window
  int height_px = 0;
  double speckle_px = kUnknown;          // full width at half maximum of the autocovariance of the
                                         // intensity, before pixel integration and blur
  double blur_px = 0.0;                  // path of the pattern during one exposure, along x
  double shift_px = 0.0;                 // of the pattern between the two frames, along x; any sign
  double mean_signal_counts = kUnknown;  // above the dark level, >= 0
  double dark_counts = 0.0;              // dark level
  double noise_sd_counts = kUnknown;     // of one pixel over time, without shot noise, >= 0
  double electrons_per_count = std::numeric_limits<double>::infinity();  // infinite: no shot noise
  int bit_depth = 8;
  double rho = 1.0;  // intensity correlation of the two frames in the same place, (0, 1]
};

/// Why there is no prediction. In order of precedence.
enum class NoiseRange {
  inside,
  not_a_number,  // an unknown or negative figure
  no_light,      // no signal, or so little that frames are refused as dark
  window,        // sides other than 48 to 512 px
  speckle,       // sizes other than 2.5 to 9 px
  blur,          // more than 1.5 speckles
  saturation,    // mean signal above 0.4 of full scale
  boiling,       // correlation under 0.5
  shift,         // more than half of the window
  few_pixels,    // clipped pixels and their neighbours are nearly everything
  low_contrast,  // frames are refused: noise hides the pattern
  few_speckles,  // peak too near to what unrelated patterns reach by chance
};

/// One sentence for a person.
std::string_view advice(NoiseRange range);

/// The parts of a sigma, to be added as squares.
struct NoiseParts {
  double noise_px = kUnknown;
  double boiling_px = kUnknown;
  double clipping_px = kUnknown;
  double interpolation_px = kUnknown;
  double sigma_px() const;
};

struct NoisePrediction {
  NoiseRange range = NoiseRange::not_a_number;
  /// NaN unless inside.
  double sigma_x_px = kUnknown;
  double sigma_y_px = kUnknown;
  NoiseParts x;
  NoiseParts y;
  /// Of such frames, as lsv measures them (ShiftQuality, GateConfig::min_contrast_to_noise). Known
  /// when the table covers the pattern, inside or not.
  double zncc = kUnknown;
  double zncc_sigmas = kUnknown;
  double contrast_to_noise = kUnknown;
  double used_px = kUnknown;  // N
};

NoisePrediction predict_noise(const NoiseConditions& conditions);

/// Steady motion followed by the odometer: every frame is measured against a keyframe, and the next
/// keyframe is taken when the variance per frame would rise.
struct TrackingNoise {
  NoiseRange range = NoiseRange::not_a_number;
  /// Of the shift from one frame to the next: the difference of two shifts against one keyframe,
  /// whose own noise cancels. Root of the mean over the life of a keyframe.
  double step_x_px = kUnknown;
  double step_y_px = kUnknown;
  /// By how much the variance of the position grows per frame. Over n frames the variance of the
  /// travel is about step^2 + (n - 1) drift.
  double drift_x_px2 = kUnknown;
  double drift_y_px2 = kUnknown;
  int frames_per_keyframe = 0;  // kFramesPerKeyframeLimit: at least that many
};

inline constexpr int kFramesPerKeyframeLimit = 10000;

/// `conditions` are those of two consecutive frames.
TrackingNoise predict_tracking_noise(const NoiseConditions& conditions);

}  // namespace lsv
