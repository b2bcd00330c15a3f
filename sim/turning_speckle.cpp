// SPDX-License-Identifier: BSD-3-Clause
#include "sim/turning_speckle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <string>

#include "sim/speckle.h"
#include "sim/speckle_optics.h"

namespace lsv::sim {
namespace {

constexpr double kFarthest_px = 1e8;
constexpr std::int64_t kFrameEnd = std::int64_t{1} << 32;

Error invalid(const char* name, double value, const char* rule) {
  char text[160];
  std::snprintf(text, sizeof text, "%s is %g but must be %s", name, value, rule);
  return {ErrorCode::invalid_argument, text};
}

Error failed(const std::exception& error) {
  return {ErrorCode::invalid_argument,
          std::string("the frame cannot be simulated: ") + error.what()};
}

/// What the camera shares with the one that does not turn.
SpeckleConfig without_turning(const TurningSpeckleConfig& c) {
  return {.width_px = c.width_px,
          .height_px = c.height_px,
          .frame_rate_hz = c.frame_rate_hz,
          .speckle_px = c.speckle_px,
          .pixel_side_px = 0.0,
          .bit_depth = c.bit_depth,
          .mean_signal_counts = c.mean_signal_counts,
          .noise_mean_counts = c.noise_mean_counts,
          .noise_sd_counts = c.noise_sd_counts,
          .seed = c.seed};
}

}  // namespace

Result<void> validate(const TurningSpeckleConfig& config) {
  if (Result<void> valid = validate(without_turning(config)); !valid) return valid;
  if (!(config.pixel_pitch_m > 0.0 && std::isfinite(config.pixel_pitch_m)))
    return invalid("pixel_pitch_m", config.pixel_pitch_m, "above 0");
  if (!(config.sc_ratio > 0.0 && std::isfinite(config.sc_ratio)))
    return invalid("sc_ratio", config.sc_ratio, "above 0");
  return {};
}

Result<TurningSpeckleCamera> TurningSpeckleCamera::create(const TurningSpeckleConfig& config) {
  if (Result<void> valid = validate(config); !valid) return valid.error();
  try {
    return TurningSpeckleCamera(config);
  } catch (const std::exception& error) {
    return failed(error);
  }
}

TurningSpeckleCamera::TurningSpeckleCamera(const TurningSpeckleConfig& config)
    : config_(config), plane_(kTurningScale, config.seed) {}

Result<void> TurningSpeckleCamera::render_intensity(const SensorPose& pose,
                                                    std::vector<double>& out) {
  const double px_per_m = config_.sc_ratio / config_.pixel_pitch_m;
  const double x_px = px_per_m * pose.x_m;
  const double y_px = px_per_m * pose.y_m;
  if (!(std::abs(x_px) <= kFarthest_px && std::abs(y_px) <= kFarthest_px))
    return invalid("distance from the origin in px", std::hypot(x_px, y_px), "at most 1e8");
  if (!std::isfinite(pose.yaw_rad)) return invalid("yaw_rad", pose.yaw_rad, "finite");
  // All below in distances between scatterers.
  const double per_px = kTurningScale * kSoftApertureFwhm / config_.speckle_px;
  const double c = per_px * std::cos(pose.yaw_rad);
  const double s = per_px * std::sin(pose.yaw_rad);
  const double middle_u = 0.5 * (config_.width_px - 1);
  const double middle_v = 0.5 * (config_.height_px - 1);
  const PlaneGrid grid{.columns = config_.width_px,
                       .rows = config_.height_px,
                       .first_x = per_px * x_px + c * middle_u - s * middle_v,
                       .first_y = per_px * y_px + s * middle_u + c * middle_v,
                       .along_row_x = -c,
                       .along_row_y = -s,
                       .down_x = s,
                       .down_y = -c};
  try {
    out.resize(static_cast<std::size_t>(config_.width_px) *
               static_cast<std::size_t>(config_.height_px));
    plane_.intensity(grid, out.data());
  } catch (const std::exception& error) {
    return failed(error);
  }
  return {};
}

Result<void> TurningSpeckleCamera::render(std::int64_t frame, const SensorPose& pose, Frame& out) {
  if (frame < 0 || frame >= kFrameEnd)
    return invalid("frame", static_cast<double>(frame), "in [0, 2^32)");
  if (Result<void> lit = render_intensity(pose, intensity_); !lit) return lit;
  const SpeckleConfig camera = without_turning(config_);
  try {
    out.reset(frame_format(camera));
  } catch (const std::exception& error) {
    return failed(error);
  }
  add_noise(frame, out);
  out.index = frame;
  out.stamp.ns = frame_stamp_ns(camera, frame);
  return {};
}

void TurningSpeckleCamera::add_noise(std::int64_t frame, Frame& out) {
  const double full_scale = full_scale_counts(config_.bit_depth);
  const double signal_counts = mean_signal_counts(without_turning(config_));
  const double* light = intensity_.data();
  std::array<float, NormalTable::kAtOnce> noise{};
  for (int row = 0; row < config_.height_px; ++row) {
    for (int column = 0; column < config_.width_px; ++column) {
      const int of_draw = column % NormalTable::kAtOnce;
      if (of_draw == 0)
        normal_.draw(config_.seed, column / NormalTable::kAtOnce, row, frame, noise);
      const double counts = signal_counts * *light++ + config_.noise_mean_counts +
                            config_.noise_sd_counts * noise[static_cast<std::size_t>(of_draw)];
      // Not negative: the cast rounds as floor does.
      const auto stored =
          static_cast<std::uint16_t>(std::min(std::max(counts + 0.5, 0.0), full_scale));
      if (config_.bit_depth == 8)
        out.row8(row)[column] = static_cast<std::uint8_t>(stored);
      else
        out.row16(row)[column] = stored;
    }
  }
}

}  // namespace lsv::sim
