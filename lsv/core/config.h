// SPDX-License-Identifier: BSD-3-Clause
// Every setting of the measuring pipeline with its unit, range and default. Defaults stand here
// and nowhere else.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "lsv/core/calibration.h"
#include "lsv/core/result.h"
#include "lsv/core/sensor_maps.h"
#include "lsv/core/shift.h"

namespace lsv {

/// How the pattern is followed from frame to frame.
enum class Preset {
  precise,  // against keyframes, nine lags around the prediction, IC-GN refinement (default)
  fast,     // the same without refinement
  classic,  // every frame against the one before, by a full search: the method of the source
};

/// How the correlation plane over the lags is computed.
enum class Engine {
  zncc,    // zero-normalised cross-correlation, exact overlap at each lag, by FFT (default)
  cross,   // plain FFT cross-correlation of mean-free frames, zero padded
  phase,   // phase correlation: the cross-power spectrum whitened
  direct,  // ZNCC summed lag by lag: O(N^2 M^2), the slow reference
};

/// Sub-pixel model of the correlation peak.
enum class PeakFit {
  sinc,        // band-limited interpolation of the plane around the peak (default)
  gaussian2d,  // least-squares 2-D Gaussian with cross term over 3 x 3 lags
  gaussian3,   // separable 3-point Gaussian
  parabola3,   // separable 3-point parabola
};

std::optional<Preset> preset_from(std::string_view word);
std::optional<Engine> engine_from(std::string_view word);
std::optional<PeakFit> peak_fit_from(std::string_view word);
std::string_view word(Preset preset);
std::string_view word(Engine engine);
std::string_view word(PeakFit fit);

/// The full search: what `classic` does for every pair, the other presets where they have no
/// prediction or it failed.
struct CorrelationConfig {
  Engine engine = Engine::zncc;
  PeakFit peak_fit = PeakFit::sinc;
  /// Lags searched along each axis: -max_shift_px .. +max_shift_px, px, >= 2. Unset: 32 (the
  /// range of the source) or half the side of the frame, whichever is less.
  std::optional<int> max_shift_px;
};

/// When a shift is refused. Ratios are dimensionless; counts are camera grey values.
struct GateConfig {
  double min_zncc = 0.2;                // [-1, 1]
  double min_zncc_sigmas = 6.0;         // against chance; follows window, overlap and speckle size
  double min_q = 4.0;                   // depends on window and speckle size: tune per data set
  double min_peak_ratio = 1.2;          // >= 0; up to 1 it refuses nothing
  double min_signal_fraction = 0.008;   // mean above camera offset, of full scale, [0, 1]
  double max_saturated_fraction = 0.5;  // of the pixels, [0, 1]
  double min_contrast_to_noise = 3.0;   // pixel spread / camera noise sd, >= 0
  bool refuse_frozen = true;            // ignored when the camera noise sd is 0
  bool refuse_inconsistent = true;      // torn frames; never with `classic`
};

struct TrackConfig {
  Preset preset = Preset::precise;
  /// Rotation and expansion from frame to frame; not with `classic`. Frames of 64 px and more.
  bool measure_deformation = false;
  /// Whether dirt on the optics and uneven light are learned while driving and taken out; never
  /// with `classic`.
  bool learn_fixed_pattern = true;
  CorrelationConfig correlation{};
  GateConfig gate{};
  Calibration calibration{};
  /// Fixed pattern of the sensor; null: not known. Of the size of the frames.
  std::shared_ptr<const SensorMaps> sensor_maps{};
};

/// The first setting that is out of its range, named with its value.
Result<void> validate(const TrackConfig& config);

}  // namespace lsv
