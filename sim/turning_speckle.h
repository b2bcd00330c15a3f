// SPDX-License-Identifier: BSD-3-Clause
// Speckle frames of a sensor that moves and turns over the ground, with its pose as the truth.
//
// The pattern is one fixed function F of a plane that is the ground enlarged by Sc / pitch, in px:
//   frame(column, row) = F(Sc / pitch (x_m, y_m) - R(yaw_rad) (u, v)),
//   (u, v) = (column, row) - middle of the frame
// It moves by Sc / pitch px along the columns for each metre of the sensor along its own x axis,
// and along the rows for each metre to its left: `lsv track` with a plain calibration (pitch and
// Sc only) reports +v in right-handed axes, x forward and y left. When the sensor turns by +yaw,
// counter-clockwise seen from above, the pattern turns about the middle of the frame from +row to
// +column.
// Orientation: columns grow towards the rear and rows towards the right of what is seen, so that
// shown with rows downwards the image is mirrored, as through one mirror. A sensor whose image is
// not mirrored has its rows the other way round, and needs the orientation in its calibration.
//
// As in speckle.h: fully developed speckle, mean 1 and contrast 1 before the camera noise.
// Approximations: point samples instead of the mean over a pixel; no exposure blur, no boiling, no
// shot noise, no fixed pattern; the field is interpolated to some 1e-3; camera noise ends at 4.2
// standard deviations.
// Reproducible: a frame depends on the configuration, its number and its pose only; to the byte in
// one build.
// Cost: 128 x 128 px take about 1.2 ms of a core on the move, new ground included.
// included. Allocates at creation and where new ground is seen. One thread at a time; cameras share
// nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "sim/normal_table.h"
#include "sim/speckle_plane.h"

namespace lsv::sim {

struct TurningSpeckleConfig {
  int width_px = 128;
  int height_px = 128;
  double frame_rate_hz = 1000.0;  // > 0; only stamps depend on it
  double pixel_pitch_m = 14e-6;   // > 0
  double sc_ratio = 2.0;          // shift of the pattern / travel, > 0
  double speckle_px = 4.0;        // full width at half maximum of the autocovariance, [0.5, 64]

  int bit_depth = 8;  // 8, 10, 12 or 16
  // As in SpeckleConfig.
  std::optional<double> mean_signal_counts{};
  double noise_mean_counts = 3.0;
  double noise_sd_counts = 0.5;
  std::uint64_t seed = 1;
};

/// Aperture scale (speckle_optics.h) in distances between the scatterers of the ground.
inline constexpr double kTurningScale = 2.7;

/// The first setting that is out of its range, named with its value.
Result<void> validate(const TurningSpeckleConfig& config);

/// Of the middle of the sensor over the ground; yaw counter-clockwise from ground x to sensor x.
struct SensorPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

class TurningSpeckleCamera {
 public:
  static Result<TurningSpeckleCamera> create(const TurningSpeckleConfig& config);

  /// Fills `out` with frame number `frame`, [0, 2^32), its stamp (0 at frame 0) and index. Poses
  /// up to 1e8 px of pattern from the origin.
  Result<void> render(std::int64_t frame, const SensorPose& pose, Frame& out);

  /// The light alone: mean 1, width x height values, row-major.
  Result<void> render_intensity(const SensorPose& pose, std::vector<double>& out);

  const TurningSpeckleConfig& config() const { return config_; }

 private:
  explicit TurningSpeckleCamera(const TurningSpeckleConfig& config);
  /// Counts of intensity_.
  void add_noise(std::int64_t frame, Frame& out);

  TurningSpeckleConfig config_;
  SpecklePlane plane_;
  NormalTable normal_;
  std::vector<double> intensity_;
};

}  // namespace lsv::sim
