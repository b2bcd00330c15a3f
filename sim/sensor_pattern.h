// SPDX-License-Identifier: BSD-3-Clause
// The fixed pattern of a simulated sensor: what stays the same from frame to frame while the ground
// moves. Gaussian offset of each pixel (dark signal nonuniformity), Gaussian gain of each pixel
// (photo response nonuniformity, cut off at 0), hot and dead pixels, and static dirt on the optics:
// round blobs that let part of the light through and add a speckle texture of their own. Terms:
// EMVA 1288 release 4.0, section 4.
//
// Units: counts of the frame's bit depth; light as a ratio of the mean signal. Maps are row-major,
// width_px x height_px. A pure function of settings, size and seed. Owned by the caller; read-only
// use from any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lsv/core/result.h"

namespace lsv::sim {

struct SensorPatternConfig {
  double dsnu_counts = 0.0;         // standard deviation of the offsets, [0, 65535]
  double prnu_ratio = 0.0;          // standard deviation of the gains, [0, 1]
  std::int64_t hot_pixels = 0;      // always at full scale; hot and dead at most half of the pixels
  std::int64_t dead_pixels = 0;     // always 0
  double dirt_share = 0.0;          // of the area, [0, 1)
  double dirt_transmission = 0.3;   // of the light behind dirt, [0, 1]
  double dirt_texture_ratio = 0.3;  // mean of the texture / mean signal, [0, 10]
  std::optional<std::uint64_t> seed{};  // unset: the seed of the camera
};

enum class PixelState : std::uint8_t { good = 0, hot = 1, dead = 2 };

/// The truth. A map is empty where its setting is off: offset 0, gain 1, all good, no dirt.
struct SensorPattern {
  std::vector<double> offset_counts;
  std::vector<double> gain_ratio;
  std::vector<PixelState> state;
  std::vector<double> transmission_ratio;  // 1 where clean
  std::vector<double> texture_ratio;       // light that dirt adds, 0 where clean

  /// What becomes of `light` (mean 1) at pixel `index`: dirt, then gain.
  double light_caught(std::size_t index, double light) const {
    if (!transmission_ratio.empty())
      light = light * transmission_ratio[index] + texture_ratio[index];
    return gain_ratio.empty() ? light : light * gain_ratio[index];
  }
};

/// The first setting that is out of its range, named with its value.
Result<void> validate(const SensorPatternConfig& config, int width_px, int height_px);

/// Valid settings only. `speckle_px` is the grain of the dirt's texture; below 4 px it is 4 px.
/// Throws std::bad_alloc and cv::Exception (memory only): the cameras are the boundary.
SensorPattern make_sensor_pattern(const SensorPatternConfig& config, int width_px, int height_px,
                                  double speckle_px, std::uint64_t seed);

}  // namespace lsv::sim
