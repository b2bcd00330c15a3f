// SPDX-License-Identifier: BSD-3-Clause
#include "sim/speckle.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

namespace lsv::sim {
namespace {

// With at least this aperture scale, in samples, the intensity (band edge 1/s) is sampled with
// room for the soft edge of the aperture.
constexpr double kMinScale_samples = 2.7;
constexpr std::int64_t kMaxPatchSamples = std::int64_t{1} << 24;
constexpr int kMaxSide_px = 4096;
constexpr double kMaxPosition_px = 1e8;
constexpr double kMaxExposurePath_px = 1e4;
constexpr std::int64_t kFrameEnd = std::int64_t{1} << 32;
constexpr double kDefaultMeanSignalRatio = 60.0 / 255.0;

Error out_of_range(const char* name, double value, const char* rule) {
  char text[160];
  std::snprintf(text, sizeof text, "%s is %g but must be %s", name, value, rule);
  return {ErrorCode::invalid_argument, text};
}

bool within(double value, double low, double high) { return value >= low && value <= high; }

int samples_per_px(double speckle_px) {
  return std::max(1,
                  static_cast<int>(std::ceil(kMinScale_samples * kSoftApertureFwhm / speckle_px)));
}

double scale_samples(double speckle_px) {
  return speckle_px / kSoftApertureFwhm * samples_per_px(speckle_px);
}

std::vector<double> weights_for(const SpeckleConfig& config) {
  return pixel_weights(config.pixel_side_px * samples_per_px(config.speckle_px),
                       scale_samples(config.speckle_px));
}

/// One sample at each pixel centre, samples_per_px apart, and the reach of the pixel weights
/// around the outermost.
FieldGeometry grid_for(const SpeckleConfig& config, int weight_count) {
  const int step = samples_per_px(config.speckle_px);
  return {(config.width_px - 1) * step + weight_count, (config.height_px - 1) * step + weight_count,
          scale_samples(config.speckle_px)};
}

Error third_party(const std::exception& error) {
  return {ErrorCode::invalid_argument,
          std::string("the frame cannot be simulated, try a smaller one: ") + error.what()};
}

}  // namespace

Result<void> validate(const SpeckleConfig& c) {
  if (!within(c.width_px, 1, kMaxSide_px))
    return out_of_range("width_px", c.width_px, "in [1, 4096]");
  if (!within(c.height_px, 1, kMaxSide_px))
    return out_of_range("height_px", c.height_px, "in [1, 4096]");
  if (!within(c.frame_rate_hz, 1e-6, 1e9))
    return out_of_range("frame_rate_hz", c.frame_rate_hz, "in [1e-6, 1e9]");
  if (!within(c.speckle_px, 0.5, 64.0))
    return out_of_range("speckle_px", c.speckle_px, "in [0.5, 64]");
  if (!within(c.pixel_side_px, 0.0, 1.0))
    return out_of_range("pixel_side_px", c.pixel_side_px, "in [0, 1]");
  if (!within(c.exposure_ratio, 0.0, 1.0))
    return out_of_range("exposure_ratio", c.exposure_ratio, "in [0, 1]");
  if (!within(c.rho, 0.0, 1.0)) return out_of_range("rho", c.rho, "in [0, 1]");
  if (c.bit_depth != 8 && c.bit_depth != 10 && c.bit_depth != 12 && c.bit_depth != 16)
    return out_of_range("bit_depth", c.bit_depth, "8, 10, 12 or 16");
  if (!within(mean_signal_counts(c), 0.0, 65535.0))
    return out_of_range("mean_signal_counts", mean_signal_counts(c), "in [0, 65535]");
  if (!within(c.noise_mean_counts, 0.0, 65535.0))
    return out_of_range("noise_mean_counts", c.noise_mean_counts, "in [0, 65535]");
  if (!within(c.noise_sd_counts, 0.0, 65535.0))
    return out_of_range("noise_sd_counts", c.noise_sd_counts, "in [0, 65535]");
  if (c.full_well_electrons && !within(*c.full_well_electrons, 1.0, 1e9))
    return out_of_range("full_well_electrons", *c.full_well_electrons, "in [1, 1e9]");
  if (Result<void> valid = validate(c.sensor, c.width_px, c.height_px); !valid) return valid;
  const FieldGeometry grid = grid_for(c, static_cast<int>(weights_for(c).size()));
  const std::int64_t patch_samples =
      std::int64_t{patch_side(grid.columns, grid.s)} * patch_side(grid.rows, grid.s);
  if (patch_samples > kMaxPatchSamples) {
    return Error{ErrorCode::invalid_argument,
                 "the frame needs " + std::to_string(patch_samples) + " simulation samples but " +
                     std::to_string(kMaxPatchSamples) +
                     " is the limit: choose a smaller frame, or a speckle size nearer to 4 px"};
  }
  return {};
}

double mean_signal_counts(const SpeckleConfig& config) {
  return config.mean_signal_counts.value_or(kDefaultMeanSignalRatio *
                                            full_scale_counts(config.bit_depth));
}

FrameFormat frame_format(const SpeckleConfig& config) {
  return {.width_px = config.width_px,
          .height_px = config.height_px,
          .type = config.bit_depth == 8 ? PixelType::mono8 : PixelType::mono16,
          .bit_depth = config.bit_depth};
}

CountsModel counts_model(const SpeckleConfig& config) {
  return {.mean_signal_counts = mean_signal_counts(config),
          .noise_mean_counts = config.noise_mean_counts,
          .noise_sd_counts = config.noise_sd_counts,
          .electrons_per_count =
              config.full_well_electrons.value_or(0.0) / full_scale_counts(config.bit_depth),
          .seed = config.seed};
}

std::int64_t frame_stamp_ns(const SpeckleConfig& config, std::int64_t frame) {
  return std::llround(static_cast<double>(frame) * static_cast<double>(kNsPerS) /
                      config.frame_rate_hz);
}

Result<SpeckleCamera> SpeckleCamera::create(const SpeckleConfig& config) {
  if (Result<void> valid = validate(config); !valid) return valid.error();
  try {
    return SpeckleCamera(config);
  } catch (const std::exception& error) {
    return third_party(error);
  }
}

SpeckleCamera::SpeckleCamera(const SpeckleConfig& config)
    : config_(config),
      pattern_(make_sensor_pattern(config.sensor, config.width_px, config.height_px,
                                   config.speckle_px, config.sensor.seed.value_or(config.seed))),
      samples_per_px_(samples_per_px(config.speckle_px)),
      s_samples_(scale_samples(config.speckle_px)),
      weights_(weights_for(config)),
      grid_(grid_for(config, static_cast<int>(weights_.size()))),
      // Siegert: the intensity correlation is the square of the field correlation.
      field_(grid_, config.seed, std::sqrt(config.rho)),
      samples_(static_cast<std::size_t>(grid_.columns) * static_cast<std::size_t>(grid_.rows)),
      columns_(static_cast<std::size_t>(config.width_px) * static_cast<std::size_t>(grid_.rows)) {}

Result<void> SpeckleCamera::check(std::int64_t frame, const PatternMotion& motion) const {
  if (frame < 0 || frame >= kFrameEnd)
    return out_of_range("frame", static_cast<double>(frame), "in [0, 2^32)");
  if (config_.rho < 1.0 && frame < last_frame_)
    return out_of_range("frame", static_cast<double>(frame),
                        "no earlier than the one before, because the speckle boils");
  if (!within(motion.x_px, -kMaxPosition_px, kMaxPosition_px))
    return out_of_range("x_px", motion.x_px, "within 1e8 px of the start");
  if (!within(motion.y_px, -kMaxPosition_px, kMaxPosition_px))
    return out_of_range("y_px", motion.y_px, "within 1e8 px of the start");
  const double path_px =
      std::hypot(motion.vx_px_per_frame, motion.vy_px_per_frame) * config_.exposure_ratio;
  if (!within(path_px, 0.0, kMaxExposurePath_px))
    return out_of_range("the path during one exposure, in px,", path_px, "at most 1e4");
  return {};
}

Result<void> SpeckleCamera::render_intensity(std::int64_t frame, const PatternMotion& motion,
                                             std::vector<double>& out) {
  if (Result<void> valid = check(frame, motion); !valid) return valid;
  try {
    expose(frame, motion);
    integrate_pixels(out);
  } catch (const std::exception& error) {
    return third_party(error);
  }
  last_frame_ = frame;
  return {};
}

Result<void> SpeckleCamera::render(std::int64_t frame, const PatternMotion& motion, Frame& out) {
  if (Result<void> light = render_intensity(frame, motion, intensity_); !light) return light;
  try {
    out.reset(frame_format(config_));
  } catch (const std::exception& error) {
    return third_party(error);
  }
  CountsModel model = counts_model(config_);
  model.pattern = &pattern_;
  to_counts(model, frame, intensity_, out);
  out.index = frame;
  out.stamp.ns = frame_stamp_ns(config_, frame);
  return {};
}

void SpeckleCamera::expose(std::int64_t frame, const PatternMotion& motion) {
  const double path_x_px = motion.vx_px_per_frame * config_.exposure_ratio;
  const double path_y_px = motion.vy_px_per_frame * config_.exposure_ratio;
  const std::size_t half_width = weights_.size() / 2;
  const auto reach = static_cast<double>(half_width);
  std::fill(samples_.begin(), samples_.end(), 0.0);
  for (const auto& [time_ratio, weight] :
       exposure_nodes(std::hypot(path_x_px, path_y_px) * samples_per_px_, s_samples_)) {
    // A pattern at position p shows ground -p at the first pixel.
    const double x_px = motion.x_px + time_ratio * path_x_px;
    const double y_px = motion.y_px + time_ratio * path_y_px;
    field_.add_intensity(frame, -x_px * samples_per_px_ - reach, -y_px * samples_per_px_ - reach,
                         weight, samples_.data());
  }
}

void SpeckleCamera::integrate_pixels(std::vector<double>& out) {
  const std::size_t step = static_cast<std::size_t>(samples_per_px_);
  const std::size_t width = static_cast<std::size_t>(config_.width_px);
  const std::size_t height = static_cast<std::size_t>(config_.height_px);
  const std::size_t grid_columns = static_cast<std::size_t>(grid_.columns);
  const std::size_t grid_rows = static_cast<std::size_t>(grid_.rows);

  std::fill(columns_.begin(), columns_.end(), 0.0);
  for (std::size_t row = 0; row < grid_rows; ++row) {
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      const double* source = samples_.data() + row * grid_columns + k;
      double* sum = columns_.data() + row * width;
      for (std::size_t x = 0; x < width; ++x) sum[x] += weights_[k] * source[x * step];
    }
  }
  out.assign(width * height, 0.0);
  for (std::size_t y = 0; y < height; ++y) {
    double* sum = out.data() + y * width;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      const double* source = columns_.data() + (y * step + k) * width;
      for (std::size_t x = 0; x < width; ++x) sum[x] += weights_[k] * source[x];
    }
  }
  // The interpolation behind the weights may undershoot a dark spot by its 1e-4 of the mean.
  for (double& intensity : out) intensity = std::max(intensity, 0.0);
}

Result<FramePair> render_pair(const SpeckleConfig& config, std::uint64_t seed, double dx_px,
                              double dy_px) {
  SpeckleConfig seeded = config;
  seeded.seed = seed;
  Result<SpeckleCamera> camera = SpeckleCamera::create(seeded);
  if (!camera) return camera.error();
  FramePair pair;
  const PatternMotion before{0.0, 0.0, dx_px, dy_px};
  if (Result<void> done = camera.value().render(0, before, pair.first); !done) return done.error();
  const PatternMotion after{dx_px, dy_px, dx_px, dy_px};
  if (Result<void> done = camera.value().render(1, after, pair.second); !done) return done.error();
  return pair;
}

}  // namespace lsv::sim
