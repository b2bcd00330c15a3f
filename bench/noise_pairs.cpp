// SPDX-License-Identifier: BSD-3-Clause
#include "bench/noise_pairs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/accuracy_pair.h"
#include "tools/simulated_loop.h"

namespace lsv::bench {
namespace {

constexpr double kOutlier_px = 1.0;
// The windows of one picture share the fraction of a px by which they move.
constexpr int kWindowsPerPicture = 16;
constexpr std::uint64_t kShiftStream = 0x9e3779b97f4a7c15;
constexpr std::uint64_t kNoiseStream = 0xd1b54a32d192ed03;

sim::SpeckleConfig picture_config(const LightSetup& setup, std::uint64_t seed) {
  sim::SpeckleConfig out;
  out.width_px = out.height_px = setup.side_px;
  out.speckle_px = setup.speckle_px;
  out.exposure_ratio = 1.0;
  out.rho = setup.rho;
  out.seed = seed;
  return out;
}

void require(const Result<void>& done) {
  if (!done) throw std::runtime_error(done.error().message);
}

ShiftMeter make_meter(const sim::SpeckleConfig& camera) {
  TrackConfig config;
  config.calibration = cli::matching_calibration(camera);
  return require_value(ShiftMeter::create(config, sim::frame_format(camera)));
}

}  // namespace

double unit_random(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

LightPairs::LightPairs(const LightSetup& setup)
    : setup_(setup), random_(setup.seed ^ kShiftStream) {
  pair_.side_px = setup.side_px;
  pair_.seed = setup.seed;
}

const LightPair& LightPairs::next() {
  ++pair_.seed;
  pair_.dx_px = setup_.shift_px + unit_random(random_) - 0.5;
  pair_.dy_px = unit_random(random_) - 0.5;
  sim::SpeckleCamera camera =
      require_value(sim::SpeckleCamera::create(picture_config(setup_, pair_.seed)));
  // The exposure lasts the whole interval, so that the speed is the blur.
  require(camera.render_intensity(0, {0.0, 0.0, setup_.blur_px, 0.0}, pair_.earlier));
  require(camera.render_intensity(1, {pair_.dx_px, pair_.dy_px, setup_.blur_px, 0.0}, pair_.later));
  return pair_;
}

double PairErrors::rmse_x_px() const { return std::sqrt(squares_x_px2 / good()); }
double PairErrors::rmse_y_px() const { return std::sqrt(squares_y_px2 / good()); }

PairMeter::PairMeter(const sim::SpeckleConfig& camera, double hidden_limit_ratio)
    : camera_(camera),
      hidden_limit_ratio_(hidden_limit_ratio),
      meter_(make_meter(camera)),
      earlier_(meter_.make_frame()),
      later_(meter_.make_frame()),
      reference_(meter_.make_reference()),
      window_(static_cast<std::size_t>(camera.width_px) *
              static_cast<std::size_t>(camera.height_px)),
      frame_(sim::frame_format(camera)) {}

void PairMeter::cut(const LightPair& light, const std::vector<double>& picture, int x_px,
                    int y_px) {
  std::size_t index = 0;
  for (int y = 0; y < camera_.height_px; ++y) {
    const double* const row =
        picture.data() + static_cast<std::ptrdiff_t>(y_px + y) * light.side_px + x_px;
    for (int x = 0; x < camera_.width_px; ++x)
      window_[index++] = std::min(row[x], hidden_limit_ratio_);
  }
}

void PairMeter::measure(const LightPair& light, int most) {
  const auto expose = [&](std::int64_t number, TrackFrame& out) {
    sim::CountsModel model = sim::counts_model(camera_);
    model.seed = (light.seed + windows_) ^ kNoiseStream;
    sim::to_counts(model, number, window_, frame_);
    out.load(frame_.view());
  };
  int measured = 0;
  for (int y = 0; y + camera_.height_px <= light.side_px; y += camera_.height_px) {
    for (int x = 0; x + camera_.width_px <= light.side_px; x += camera_.width_px) {
      if (measured++ >= most) return;
      ++windows_;
      cut(light, light.earlier, x, y);
      expose(0, earlier_);
      cut(light, light.later, x, y);
      expose(1, later_);
      ++errors_.pairs;
      double error_x_px = kUnknown;
      double error_y_px = kUnknown;
      if (meter_.fitness(earlier_) == ShiftStatus::ok &&
          meter_.fitness(later_) == ShiftStatus::ok) {
        meter_.build(earlier_, reference_);
        const Shift found =
            meter_.refine(earlier_, reference_, later_, meter_.acquire(earlier_, later_)).shift;
        error_x_px = found.dx_px - light.dx_px;
        error_y_px = found.dy_px - light.dy_px;
      }
      // Written so that NaN is an outlier.
      if (!(std::abs(error_x_px) <= kOutlier_px && std::abs(error_y_px) <= kOutlier_px)) {
        ++errors_.outliers;
        continue;
      }
      errors_.squares_x_px2 += error_x_px * error_x_px;
      errors_.squares_y_px2 += error_y_px * error_y_px;
    }
  }
}

PairErrors measure_pairs(const LightSetup& light, const sim::SpeckleConfig& camera, int pairs) {
  LightPairs source(light);
  PairMeter meter(camera);
  while (meter.errors().pairs < pairs)
    meter.measure(source.next(), std::min(kWindowsPerPicture, pairs - meter.errors().pairs));
  return meter.errors();
}

}  // namespace lsv::bench
