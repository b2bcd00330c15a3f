// SPDX-License-Identifier: BSD-3-Clause
#include "sim/camera_counts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/philox.h"

namespace lsv::sim {
namespace {

/// Standard normal number of one pixel; neighbours in a row share one draw of two.
class PixelNormal {
 public:
  PixelNormal(std::uint64_t seed, Stream stream, std::int64_t frame)
      : seed_(seed), stream_(stream), frame_(frame) {}

  double at(int x_px, int y_px) {
    const int column_pair = x_px / 2;
    if (column_pair != column_pair_ || y_px != y_px_) {
      pair_ = std::numbers::sqrt2 * complex_normal(seed_, stream_, column_pair, y_px, frame_);
      column_pair_ = column_pair;
      y_px_ = y_px;
    }
    return x_px % 2 == 0 ? pair_.real() : pair_.imag();
  }

 private:
  std::uint64_t seed_;
  Stream stream_;
  std::int64_t frame_;
  int column_pair_ = -1;
  int y_px_ = -1;
  std::complex<double> pair_;
};

/// Poisson number by inversion of its distribution function at u in (0, 1].
double poisson_by_inversion(double mean, double u) {
  double probability = std::exp(-mean);
  double below = probability;
  double n = 0.0;
  while (below < u && probability > 0.0) {
    n += 1.0;
    probability *= mean / n;
    below += probability;
  }
  return n;
}

/// From this mean on the normal distribution stands in for Poisson's.
constexpr double kNormalFromElectrons = 64.0;

double electrons_caught(const CountsModel& model, double mean_electrons, int x_px, int y_px,
                        std::int64_t frame) {
  const auto [u, v] = uniform_pair(model.seed, Stream::shot_noise, x_px, y_px, frame);
  if (mean_electrons < kNormalFromElectrons) return poisson_by_inversion(mean_electrons, u);
  const double normal = std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
  return std::max(0.0, std::floor(mean_electrons + std::sqrt(mean_electrons) * normal + 0.5));
}

}  // namespace

void to_counts(const CountsModel& model, std::int64_t frame, const std::vector<double>& intensity,
               Frame& out) {
  const FrameFormat format = out.view().format;
  const double full_scale = full_scale_counts(format.bit_depth);
  PixelNormal noise(model.seed, Stream::camera_noise, frame);
  const SensorPattern none;
  const SensorPattern& pattern = model.pattern != nullptr ? *model.pattern : none;
  std::size_t index = 0;
  for (int y = 0; y < format.height_px; ++y) {
    for (int x = 0; x < format.width_px; ++x) {
      const std::size_t pixel = index++;
      const double light = pattern.light_caught(pixel, intensity[pixel]);
      double signal_counts = model.mean_signal_counts * light;
      if (model.electrons_per_count > 0.0) {
        signal_counts =
            electrons_caught(model, signal_counts * model.electrons_per_count, x, y, frame) /
            model.electrons_per_count;
      }
      double counts = signal_counts + model.noise_mean_counts;
      if (!pattern.offset_counts.empty()) counts += pattern.offset_counts[pixel];
      if (model.noise_sd_counts > 0.0) counts += model.noise_sd_counts * noise.at(x, y);
      if (!pattern.state.empty()) {
        if (pattern.state[pixel] == PixelState::hot) counts = full_scale;
        if (pattern.state[pixel] == PixelState::dead) counts = 0.0;
      }
      const double stored = std::clamp(std::floor(counts + 0.5), 0.0, full_scale);
      if (format.type == PixelType::mono8) {
        out.row8(y)[x] = static_cast<std::uint8_t>(stored);
      } else {
        out.row16(y)[x] = static_cast<std::uint16_t>(stored);
      }
    }
  }
}

}  // namespace lsv::sim
