// SPDX-License-Identifier: BSD-3-Clause
// A speckle-like test pattern with exactly known motion that shares no code with sim/: the
// intensity of random plane waves, a closed formula of the coordinates, so any sub-pixel shift is
// exact.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "lsv/core/frame.h"

namespace lsv::test {

class PlaneWavePattern {
 public:
  /// `speckle_px`: about the full width at half maximum of a speckle.
  PlaneWavePattern(std::uint32_t seed, double speckle_px, int waves = 200) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    const double k_max = std::numbers::pi * 1.029 / speckle_px;
    for (int i = 0; i < waves; ++i) {
      const double radius = k_max * std::sqrt(uniform());
      const double angle = 2.0 * std::numbers::pi * uniform();
      waves_.push_back(
          {radius * std::cos(angle), radius * std::sin(angle), 2.0 * std::numbers::pi * uniform()});
    }
  }

  /// Intensity with mean 1, of the pattern moved by (x0, y0) px, at pixel (x, y).
  double at(double x_px, double y_px) const {
    std::complex<double> field = 0.0;
    for (const Wave& wave : waves_)
      field += std::polar(1.0, wave.kx * x_px + wave.ky * y_px + wave.phase);
    return std::norm(field) / static_cast<double>(waves_.size());
  }

  /// A frame of the pattern moved by (x0_px, y0_px), rounded and clipped to full scale.
  Frame frame(const FrameFormat& format, double x0_px, double y0_px, double mean_counts) const {
    Frame out(format);
    const double full_scale = full_scale_counts(format.bit_depth);
    for (int y = 0; y < format.height_px; ++y) {
      for (int x = 0; x < format.width_px; ++x) {
        const double counts =
            std::min(full_scale, std::round(mean_counts * at(x - x0_px, y - y0_px)));
        if (format.type == PixelType::mono8)
          out.row8(y)[x] = static_cast<std::uint8_t>(counts);
        else
          out.row16(y)[x] = static_cast<std::uint16_t>(counts);
      }
    }
    return out;
  }

 private:
  struct Wave {
    double kx, ky, phase;
  };
  std::vector<Wave> waves_;
};

}  // namespace lsv::test
