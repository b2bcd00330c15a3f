// SPDX-License-Identifier: BSD-3-Clause
// A simulated camera that looks at moving laser speckle, with the truth known to 1e-5 px.
//
// Physics, in order: fully developed speckle (a complex circular Gaussian field behind a circular
// aperture, speckle_field.h; intensity = |field|^2, mean 1, contrast 1); exposure blur along the
// straight path of the pattern during the exposure; mean over the light-sensitive square of each
// pixel; fixed pattern of the sensor (sensor_pattern.h); shot noise; camera noise; rounding to
// integers; clipping to [0, full scale].
// Approximations: the edge of the aperture is soft (speckle_optics.h); the field does not boil
// within one exposure; translation only.
//
// Units and signs: lengths in px, intensity in counts of the bit depth of the frame. Position and
// velocity are those of the pattern on the sensor, positive to larger columns and rows.
// Reproducible: same config, same sequence of calls, same bytes; the arithmetic is in double, so
// that compilers and libraries that differ in the last bit do not move a count.
// Owns all buffers; allocates at creation, and while rendering where new ground is seen. One
// camera belongs to one thread at a time; cameras do not share state.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "sim/camera_counts.h"
#include "sim/motion_profile.h"
#include "sim/sensor_pattern.h"
#include "sim/speckle_field.h"
#include "sim/speckle_optics.h"

namespace lsv::sim {

struct SpeckleConfig {
  int width_px = 128;
  int height_px = 128;
  double frame_rate_hz = 1000.0;  // > 0; only stamps depend on it
  /// Full width at half maximum of the intensity autocovariance before pixel integration,
  /// [0.5, 64]. Below about 3 px the frame is simulated on a finer grid and takes longer.
  double speckle_px = 4.0;
  double pixel_side_px = 1.0;   // of the light-sensitive square, [0, 1]; 0 = point samples
  double exposure_ratio = 0.0;  // exposure time / frame interval, [0, 1]
  /// Correlation of the intensity between consecutive frames of a pattern at rest, [0, 1]; over
  /// n frames it is rho^n. 1 = no boiling.
  double rho = 1.0;

  int bit_depth = 8;                            // 8, 10, 12 or 16
  std::optional<double> mean_signal_counts{};   // speckle without camera noise; unset: 60/255 of
                                                // full scale
  double noise_mean_counts = 3.0;               // dark level
  double noise_sd_counts = 0.5;                 // Gaussian, independent per pixel and frame
  std::optional<double> full_well_electrons{};  // signal at full scale; unset: no shot noise
  SensorPatternConfig sensor{};                 // fixed pattern; off unless set
  std::uint64_t seed = 1;
};

/// The first setting that is out of its range, named with its value.
Result<void> validate(const SpeckleConfig& config);

/// The setting, or its default at this bit depth.
double mean_signal_counts(const SpeckleConfig& config);

/// mono8 for 8 bits, mono16 above.
FrameFormat frame_format(const SpeckleConfig& config);

/// From light to counts with these settings, without the fixed pattern.
CountsModel counts_model(const SpeckleConfig& config);

/// Stamp of a frame, ns; 0 at frame 0.
std::int64_t frame_stamp_ns(const SpeckleConfig& config, std::int64_t frame);

class SpeckleCamera {
 public:
  static Result<SpeckleCamera> create(const SpeckleConfig& config);

  /// Fills `out` with frame number `frame`, [0, 2^32), its stamp (0 at frame 0) and index.
  /// Positions up to 1e8 px, exposure paths up to 1e4 px. With boiling, `frame` must not decrease
  /// from call to call; without, any order gives the same frames.
  Result<void> render(std::int64_t frame, const PatternMotion& motion, Frame& out);

  /// The light alone: mean 1, width x height values, row-major; no fixed pattern, noise, rounding
  /// or clipping.
  Result<void> render_intensity(std::int64_t frame, const PatternMotion& motion,
                                std::vector<double>& out);

  const SpeckleConfig& config() const { return config_; }
  /// The true maps of the sensor.
  const SensorPattern& pattern() const { return pattern_; }

 private:
  explicit SpeckleCamera(const SpeckleConfig& config);
  Result<void> check(std::int64_t frame, const PatternMotion& motion) const;
  void expose(std::int64_t frame, const PatternMotion& motion);
  void integrate_pixels(std::vector<double>& out);

  SpeckleConfig config_;
  SensorPattern pattern_;
  int samples_per_px_ = 1;
  double s_samples_ = 0.0;
  std::vector<double> weights_;  // of the pixel, per grid sample
  FieldGeometry grid_;
  SpeckleField field_;
  std::vector<double> samples_;    // light on the grid
  std::vector<double> columns_;    // light integrated along x only
  std::vector<double> intensity_;  // light per pixel
  std::int64_t last_frame_ = 0;
};

/// Two frames of one camera: the pattern moved by (dx_px, dy_px) from first to second. `seed`
/// takes the place of config.seed. For tests and benchmarks.
struct FramePair {
  Frame first;
  Frame second;
};
Result<FramePair> render_pair(const SpeckleConfig& config, std::uint64_t seed, double dx_px,
                              double dy_px);

}  // namespace lsv::sim
