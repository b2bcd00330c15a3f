// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensor_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "sim/philox.h"
#include "sim/speckle_field.h"
#include "sim/speckle_optics.h"

namespace lsv::sim {
namespace {

constexpr double kMinTexture_px = 4.0;
/// Radii of the blobs, as a share of the shorter side.
constexpr double kMinBlobRatio = 0.02;
constexpr double kMaxBlobRatio = 0.10;
constexpr int kDrawsForCentre = 64;

/// What a number of Stream::sensor_pattern is drawn for.
enum class Part : std::uint32_t { offset, gain, defects, dirt, texture };

Error out_of_range(const char* name, double value, const char* rule) {
  char text[160];
  std::snprintf(text, sizeof text, "%s is %g but must be %s", name, value, rule);
  return {ErrorCode::invalid_argument, text};
}

bool within(double value, double low, double high) { return value >= low && value <= high; }

/// A sequence of numbers that no other part shares.
class Draws {
 public:
  Draws(std::uint64_t seed, Part part) : seed_(seed), part_(part) {}

  std::array<double, 2> uniform() {
    return uniform_pair(seed_, Stream::sensor_pattern, next_++, 0,
                        static_cast<std::int64_t>(part_));
  }
  /// Uniform in [0, end).
  std::size_t index(std::size_t end) {
    const auto k = static_cast<std::size_t>((1.0 - uniform()[0]) * static_cast<double>(end));
    return std::min(k, end - 1);
  }
  double normal() {
    const auto [u, v] = uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
  }

 private:
  std::uint64_t seed_;
  Part part_;
  std::int64_t next_ = 0;
};

std::vector<double> normal_map(std::size_t pixels, double mean, double sd, Draws draws) {
  std::vector<double> map(pixels);
  for (double& value : map) value = mean + sd * draws.normal();
  return map;
}

void place(std::vector<PixelState>& map, std::int64_t count, PixelState state, Draws& draws) {
  while (count > 0) {
    PixelState& pixel = map[draws.index(map.size())];
    if (pixel != PixelState::good) continue;
    pixel = state;
    --count;
  }
}

/// Covers pixels with round blobs until the share is reached.
class Dirt {
 public:
  Dirt(int width_px, int height_px, std::uint64_t seed)
      : width_px_(width_px),
        height_px_(height_px),
        draws_(seed, Part::dirt),
        dirty_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}

  const std::vector<std::uint8_t>& cover(double share) {
    double missing_px = std::floor(share * static_cast<double>(dirty_.size()) + 0.5);
    const double side_px = std::min(width_px_, height_px_);
    while (missing_px >= 1.0) {
      const double drawn_px =
          side_px * (kMinBlobRatio + (kMaxBlobRatio - kMinBlobRatio) * draws_.uniform()[0]);
      missing_px -=
          add_blob(clean_pixel(), std::min(drawn_px, std::sqrt(missing_px / std::numbers::pi)));
    }
    return dirty_;
  }

 private:
  /// A clean pixel, so that every blob covers at least one more.
  std::size_t clean_pixel() {
    for (int draw = 0; draw < kDrawsForCentre; ++draw) {
      const std::size_t k = draws_.index(dirty_.size());
      if (dirty_[k] == 0) return k;
    }
    const auto clean = std::find(dirty_.begin(), dirty_.end(), 0);
    return static_cast<std::size_t>(clean - dirty_.begin());
  }

  /// The number of pixels that it covers and that were clean.
  double add_blob(std::size_t centre, double radius_px) {
    const auto width = static_cast<std::size_t>(width_px_);
    const int cx_px = static_cast<int>(centre % width);
    const int cy_px = static_cast<int>(centre / width);
    const int reach_px = static_cast<int>(radius_px);
    double covered_px = 0.0;
    for (int y = std::max(0, cy_px - reach_px); y <= std::min(height_px_ - 1, cy_px + reach_px);
         ++y) {
      for (int x = std::max(0, cx_px - reach_px); x <= std::min(width_px_ - 1, cx_px + reach_px);
           ++x) {
        if (std::hypot(x - cx_px, y - cy_px) > radius_px) continue;
        std::uint8_t& pixel =
            dirty_[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
        covered_px += pixel == 0 ? 1.0 : 0.0;
        pixel = 1;
      }
    }
    return covered_px;
  }

  int width_px_;
  int height_px_;
  Draws draws_;
  std::vector<std::uint8_t> dirty_;
};

/// Speckle at rest, mean 1, of a seed of its own.
std::vector<double> texture_map(int width_px, int height_px, double speckle_px,
                                std::uint64_t seed) {
  const PhiloxWords words = philox4x32({0, 0, static_cast<std::uint32_t>(Part::texture),
                                        static_cast<std::uint32_t>(Stream::sensor_pattern)},
                                       seed);
  const std::uint64_t texture_seed = (std::uint64_t{words[0]} << 32) | words[1];
  SpeckleField field(
      {width_px, height_px, std::max(speckle_px, kMinTexture_px) / kSoftApertureFwhm}, texture_seed,
      1.0);
  std::vector<double> map(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  field.add_intensity(0, 0.0, 0.0, 1.0, map.data());
  return map;
}

}  // namespace

Result<void> validate(const SensorPatternConfig& c, int width_px, int height_px) {
  if (!within(c.dsnu_counts, 0.0, 65535.0))
    return out_of_range("dsnu_counts", c.dsnu_counts, "in [0, 65535]");
  if (!within(c.prnu_ratio, 0.0, 1.0)) return out_of_range("prnu_ratio", c.prnu_ratio, "in [0, 1]");
  const std::int64_t half = std::int64_t{width_px} * height_px / 2;
  if (c.hot_pixels < 0 || c.hot_pixels > half)
    return out_of_range("hot_pixels", static_cast<double>(c.hot_pixels),
                        "from 0 to half of the pixels");
  if (c.dead_pixels < 0 || c.dead_pixels > half - c.hot_pixels)
    return out_of_range("dead_pixels", static_cast<double>(c.dead_pixels),
                        "from 0 to half of the pixels, with the hot ones");
  if (!(c.dirt_share >= 0.0 && c.dirt_share < 1.0))
    return out_of_range("dirt_share", c.dirt_share, "in [0, 1)");
  if (!within(c.dirt_transmission, 0.0, 1.0))
    return out_of_range("dirt_transmission", c.dirt_transmission, "in [0, 1]");
  if (!within(c.dirt_texture_ratio, 0.0, 10.0))
    return out_of_range("dirt_texture_ratio", c.dirt_texture_ratio, "in [0, 10]");
  return {};
}

SensorPattern make_sensor_pattern(const SensorPatternConfig& config, int width_px, int height_px,
                                  double speckle_px, std::uint64_t seed) {
  const auto pixels = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
  SensorPattern pattern;
  if (config.dsnu_counts > 0.0) {
    pattern.offset_counts = normal_map(pixels, 0.0, config.dsnu_counts, {seed, Part::offset});
  }
  if (config.prnu_ratio > 0.0) {
    pattern.gain_ratio = normal_map(pixels, 1.0, config.prnu_ratio, {seed, Part::gain});
    for (double& gain : pattern.gain_ratio) gain = std::max(gain, 0.0);
  }
  if (config.hot_pixels + config.dead_pixels > 0) {
    pattern.state.assign(pixels, PixelState::good);
    Draws draws(seed, Part::defects);
    place(pattern.state, config.hot_pixels, PixelState::hot, draws);
    place(pattern.state, config.dead_pixels, PixelState::dead, draws);
  }
  if (config.dirt_share > 0.0) {
    Dirt dirt(width_px, height_px, seed);
    const std::vector<std::uint8_t>& dirty = dirt.cover(config.dirt_share);
    pattern.texture_ratio = texture_map(width_px, height_px, speckle_px, seed);
    pattern.transmission_ratio.resize(pixels);
    for (std::size_t k = 0; k < pixels; ++k) {
      pattern.transmission_ratio[k] = dirty[k] != 0 ? config.dirt_transmission : 1.0;
      pattern.texture_ratio[k] *= dirty[k] != 0 ? config.dirt_texture_ratio : 0.0;
    }
  }
  return pattern;
}

}  // namespace lsv::sim
