// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/odometer.h"

#include <cmath>
#include <cstdint>
#include <new>
#include <string>
#include <utility>

namespace lsv {
namespace {

std::string size_text(const FrameFormat& format) {
  return std::to_string(format.width_px) + " x " + std::to_string(format.height_px) + " px";
}

/// 16-bit pixels must lie where such words may be read, and hold no more bits than announced.
Result<void> check_words(const FrameView& frame) {
  const auto refuse = [&](const char* why) {
    return Error{ErrorCode::bad_input, "frame " + std::to_string(frame.index) + why};
  };
  if (reinterpret_cast<std::uintptr_t>(frame.data) % 2 != 0 || frame.stride_bytes % 2 != 0)
    return refuse(": rows of 16-bit pixels must begin at even addresses");
  unsigned bits = 0;
  for (int y = 0; y < frame.height_px(); ++y) {
    const std::uint16_t* const row = frame.row16(y);
    for (int x = 0; x < frame.width_px(); ++x) bits |= row[x];
  }
  if (bits > static_cast<unsigned>(full_scale_counts(frame.format.bit_depth)))
    return refuse(" has pixels above the full scale of its bit depth");
  return {};
}

SensorPosition position_of(const PatternStep& step, const PixelScale& scale) {
  const Travel so_far = travel(step.x_px, step.y_px, step.position_cov, scale);
  return {.x_m = so_far.x_m,
          .y_m = so_far.y_m,
          .sigma_x_m = so_far.sigma_x_m,
          .sigma_y_m = so_far.sigma_y_m};
}

}  // namespace

Result<Odometer> Odometer::create(const TrackConfig& config, const FrameFormat& format) {
  if (const Result<void> valid = validate(config); !valid) return valid.error();
  if (!is_possible(format)) {
    return Error{ErrorCode::invalid_argument, "frames of " + size_text(format) + " with " +
                                                  std::to_string(format.bit_depth) +
                                                  " bit cannot be tracked"};
  }
  try {
    Result<Follower> follower = make_follower(config, format);
    if (!follower) return follower.error();
    return Odometer(config, format, std::move(follower).value());
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::invalid_argument,
                 "there is not enough memory for frames of " + size_text(format) +
                     " with this search range: use --roi or a smaller --max-shift"};
  }
}

Result<Odometer::Follower> Odometer::make_follower(const TrackConfig& config,
                                                   const FrameFormat& format) {
  const bool learns = config.learn_fixed_pattern && config.preset != Preset::classic;
  Result<FixedPattern> made_pattern = FixedPattern::create(config, format, learns);
  if (!made_pattern) return made_pattern.error();
  FixedPattern fixed_pattern = std::move(made_pattern).value();
  if (config.preset == Preset::classic) {
    Result<FrameToFrame> classic = FrameToFrame::create(config, format, std::move(fixed_pattern));
    if (!classic) return classic.error();
    return Follower(std::move(classic).value());
  }
  Result<ShiftMeter> meter = ShiftMeter::create(config, format);
  if (!meter) return meter.error();
  std::optional<DeformationMeter> deformation;
  if (config.measure_deformation) {
    Result<DeformationMeter> made =
        DeformationMeter::create(format, config.calibration.noise_sd_counts);
    if (!made) return made.error();
    deformation.emplace(std::move(made).value());
  }
  return Follower(
      KeyframeOdometry(std::move(meter).value(), std::move(fixed_pattern), std::move(deformation)));
}

Odometer::Odometer(const TrackConfig& config, const FrameFormat& format, Follower follower)
    : format_(format), scale_(pixel_scale(config.calibration)), follower_(std::move(follower)) {}

Result<StepReport> Odometer::push(const FrameView& frame) {
  if (const Result<void> usable = check(frame); !usable) return usable.error();
  const bool is_first = !last_stamp_;
  const PatternStep step =
      std::visit([&frame](auto& follower) { return follower.step(frame); }, follower_);
  last_stamp_ = frame.stamp;

  StepReport report{.frame = frame.index, .stamp = frame.stamp};
  report.shift = step.shift;
  report.search = step.search;
  report.keyframe = step.keyframe;
  report.segment = step.segment;
  report.motion = step.motion;
  report.deformation = step.deformation;
  report.static_share = step.static_share;
  report.position = position_of(step, scale_);
  if (is_first) {
    first_stamp_ = frame.stamp;
    return report;
  }
  report.dt_ns = frame.stamp.ns - step.since.ns;
  if (step.shift.status == ShiftStatus::ok)
    report.velocity =
        velocity(travel(step.shift, scale_), seconds_between(step.since, frame.stamp));
  return report;
}

Result<void> Odometer::check(const FrameView& frame) const {
  if (frame.format != format_) {
    return Error{ErrorCode::bad_input,
                 "frame " + std::to_string(frame.index) + " is " + size_text(frame.format) + ", " +
                     std::to_string(frame.format.bit_depth) + " bit, unlike the frames before it"};
  }
  if (frame.format.type == PixelType::mono16) {
    if (Result<void> usable = check_words(frame); !usable) return usable;
  }
  if (!last_stamp_) return {};
  // No two stamps of one run may be further apart than their difference can hold.
  std::int64_t dt_ns = 0;
  const bool overflows = __builtin_sub_overflow(frame.stamp.ns, first_stamp_.ns, &dt_ns);
  if (frame.stamp <= *last_stamp_ || overflows) {
    return Error{ErrorCode::bad_input, "the time stamp of frame " + std::to_string(frame.index) +
                                           (overflows ? " is out of range" : " does not increase")};
  }
  return {};
}

const LagRange& Odometer::lags() const {
  return std::visit([](const auto& follower) -> const LagRange& { return follower.lags(); },
                    follower_);
}

const CorrelationPlane& Odometer::plane() {
  return std::visit([](auto& follower) -> const CorrelationPlane& { return follower.plane(); },
                    follower_);
}

}  // namespace lsv
