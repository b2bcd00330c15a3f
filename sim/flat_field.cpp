// SPDX-License-Identifier: BSD-3-Clause
#include "sim/flat_field.h"

#include <bit>
#include <cmath>
#include <exception>
#include <string>

#include "sim/camera_counts.h"
#include "sim/philox.h"

namespace lsv::sim {
namespace {

constexpr std::int64_t kFrameEnd = std::int64_t{1} << 32;

/// Two levels of light share no noise, or their difference would be free of it.
std::uint64_t noise_seed(const SpeckleConfig& config) {
  const auto level = std::bit_cast<std::uint64_t>(mean_signal_counts(config));
  const PhiloxWords words =
      philox4x32({static_cast<std::uint32_t>(level), static_cast<std::uint32_t>(level >> 32), 0,
                  static_cast<std::uint32_t>(Stream::flat_field)},
                 config.seed);
  return (std::uint64_t{words[0]} << 32) | words[1];
}

Error third_party(const std::exception& error) {
  return {ErrorCode::invalid_argument,
          std::string("the frame cannot be simulated, try a smaller one: ") + error.what()};
}

}  // namespace

Result<FlatFieldCamera> FlatFieldCamera::create(const SpeckleConfig& config,
                                                double gradient_ratio) {
  if (Result<void> valid = validate(config); !valid) return valid.error();
  if (!(gradient_ratio >= -1.0 && gradient_ratio <= 1.0)) {
    return Error{ErrorCode::invalid_argument,
                 "gradient_ratio is " + std::to_string(gradient_ratio) + " but must be in [-1, 1]"};
  }
  try {
    return FlatFieldCamera(config, gradient_ratio);
  } catch (const std::exception& error) {
    return third_party(error);
  }
}

FlatFieldCamera::FlatFieldCamera(const SpeckleConfig& config, double gradient_ratio)
    : config_(config),
      pattern_(make_sensor_pattern(config.sensor, config.width_px, config.height_px,
                                   config.speckle_px, config.sensor.seed.value_or(config.seed))),
      light_(static_cast<std::size_t>(config.width_px) * static_cast<std::size_t>(config.height_px),
             1.0) {
  const auto width = static_cast<std::size_t>(config.width_px);
  if (width < 2) return;
  for (std::size_t i = 0; i < light_.size(); ++i) {
    const auto column = static_cast<double>(i % width);
    light_[i] += gradient_ratio * (column / static_cast<double>(width - 1) - 0.5);
  }
}

Result<void> FlatFieldCamera::render(std::int64_t frame, Frame& out) {
  if (frame < 0 || frame >= kFrameEnd) {
    return Error{ErrorCode::invalid_argument,
                 "frame is " + std::to_string(frame) + " but must be in [0, 2^32)"};
  }
  try {
    out.reset(frame_format(config_));
  } catch (const std::exception& error) {
    return third_party(error);
  }
  CountsModel model = counts_model(config_);
  model.seed = noise_seed(config_);
  model.pattern = &pattern_;
  to_counts(model, frame, light_, out);
  out.index = frame;
  out.stamp.ns = frame_stamp_ns(config_, frame);
  return {};
}

}  // namespace lsv::sim
