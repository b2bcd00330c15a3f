// SPDX-License-Identifier: BSD-3-Clause
// Many simulated pairs of frames at little cost, and the errors of the preset `precise` on them:
// windows cut from larger pictures, each with camera noise of its own.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/shift_meter.h"
#include "sim/speckle.h"

namespace lsv::bench {

/// [0, 1), the same with every standard library.
double unit_random(std::mt19937_64& engine);

struct LightSetup {
  double speckle_px = 4.0;
  double blur_px = 0.0;   // path during the exposure, along x
  double shift_px = 0.0;  // from one frame to the other along x; none along y
  double rho = 1.0;       // intensity correlation of the two frames
  int side_px = 512;
  std::uint64_t seed = 1;
};

/// The light of two frames, mean 1, row-major.
struct LightPair {
  int side_px = 0;
  double dx_px = 0.0;
  double dy_px = 0.0;
  std::uint64_t seed = 0;
  std::vector<double> earlier;
  std::vector<double> later;
};

/// New ground for every pair. Each shift is that of the setup and half a px more or less along
/// either axis, uniform. Throws std::runtime_error when the setup is out of range.
class LightPairs {
 public:
  explicit LightPairs(const LightSetup& setup);
  const LightPair& next();

 private:
  LightSetup setup_;
  std::mt19937_64 random_;
  LightPair pair_;
};

/// Errors of the accepted shifts. An error above 1 px, or no answer, is an outlier.
struct PairErrors {
  int pairs = 0;
  int outliers = 0;
  double squares_x_px2 = 0.0;
  double squares_y_px2 = 0.0;

  int good() const { return pairs - outliers; }
  double rmse_x_px() const;
  double rmse_y_px() const;
};

/// Measures the windows of a picture; one camera, one window size.
class PairMeter {
 public:
  /// `camera` is that of one window: its size, bit depth, signal and noise count. Light above
  /// `hidden_limit_ratio` (of the mean) is cut off where the tracker cannot notice.
  explicit PairMeter(const sim::SpeckleConfig& camera, double hidden_limit_ratio = 1e9);

  /// At most `most` windows of `light` that do not overlap.
  void measure(const LightPair& light, int most);

  const PairErrors& errors() const { return errors_; }

 private:
  void cut(const LightPair& light, const std::vector<double>& picture, int x_px, int y_px);

  sim::SpeckleConfig camera_;
  double hidden_limit_ratio_;
  ShiftMeter meter_;
  TrackFrame earlier_;
  TrackFrame later_;
  TrackReference reference_;
  std::vector<double> window_;
  Frame frame_;
  std::uint64_t windows_ = 0;
  PairErrors errors_;
};

/// `pairs` pairs from as many pictures as it takes.
PairErrors measure_pairs(const LightSetup& light, const sim::SpeckleConfig& camera, int pairs);

}  // namespace lsv::bench
