// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/fixed_pattern.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "lsv/core/shift.h"

namespace lsv {
namespace {

std::string size_text(int width_px, int height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px) + " px";
}

/// Why `config` cannot be meant for such frames.
std::optional<std::string> contradiction(const TrackConfig& config, const FrameFormat& format) {
  const SensorMaps* const maps = config.sensor_maps.get();
  if (maps == nullptr && config.calibration.maps) {
    return "the calibration names sensor maps (" + config.calibration.maps->file +
           ") but none are set: load both with set_calibration() of lsv/sensor_setup.h";
  }
  if (maps != nullptr &&
      (maps->width_px != format.width_px || maps->height_px != format.height_px)) {
    return "the sensor maps are for " + size_text(maps->width_px, maps->height_px) +
           ", the frames are " + size_text(format.width_px, format.height_px);
  }
  const std::optional<SensorFormat>& calibrated = config.calibration.format;
  if (!calibrated) return std::nullopt;
  if (calibrated->bit_depth != format.bit_depth) {
    return "the calibration is for frames with " + std::to_string(calibrated->bit_depth) +
           " bit, these have " + std::to_string(format.bit_depth);
  }
  // Smaller ones may be a region.
  if (format.width_px > calibrated->width_px || format.height_px > calibrated->height_px) {
    return "the calibration is for frames of " +
           size_text(calibrated->width_px, calibrated->height_px) + ", these are " +
           size_text(format.width_px, format.height_px);
  }
  return std::nullopt;
}

}  // namespace

Result<FixedPattern> FixedPattern::create(const TrackConfig& config, const FrameFormat& format,
                                          bool learn) {
  if (const std::optional<std::string> why = contradiction(config, format))
    return Error{ErrorCode::invalid_argument, *why};
  return FixedPattern(format, config.calibration.noise_mean_counts, config.sensor_maps.get(),
                      learn);
}

FixedPattern::FixedPattern(const FrameFormat& format, double dark_counts, const SensorMaps* maps,
                           bool learn)
    : format_(format), dark_counts_(static_cast<float>(dark_counts)), static_share_(kUnknown) {
  if (maps == nullptr && !learn) return;
  const auto pixels =
      static_cast<std::size_t>(format.width_px) * static_cast<std::size_t>(format.height_px);
  out_.reset(format);
  filler_ = HoleFiller(format);
  map_factor_.assign(pixels, 1.0F);
  map_less_.assign(pixels, dark_counts_);
  map_holes_.assign(pixels, 0);
  if (maps != nullptr) {
    corrects_ = true;
    map_holes_ = maps->defect;
    for (std::size_t i = 0; i < pixels; ++i) {
      map_factor_[i] = 1.0F / maps->gain_ratio[i];
      map_less_[i] = maps->offset_counts[i] * map_factor_[i];
    }
  }
  factor_ = map_factor_;
  less_ = map_less_;
  holes_ = map_holes_;
  filler_.set(holes_);
  if (learn) learner_ = PatternLearner(format, map_holes_);
}

FrameView FixedPattern::corrected(const FrameView& raw) {
  if (!corrects_) return raw;
  if (format_.type == PixelType::mono8)
    correct<std::uint8_t>(raw);
  else
    correct<std::uint16_t>(raw);
  filler_.fill(out_);
  FrameView out = out_.view();
  out.stamp = raw.stamp;
  out.index = raw.index;
  return out;
}

template <typename Pixel>
void FixedPattern::correct(const FrameView& raw) {
  const int width = format_.width_px;
  const float full_scale = static_cast<float>(full_scale_counts(format_.bit_depth));
  const float highest = full_scale - 1.0F;
  const float to_nearest = dark_counts_ + 0.5F;  // as fast as lround() is slow
  for (int y = 0; y < format_.height_px; ++y) {
    const auto* const from = reinterpret_cast<const Pixel*>(raw.data + y * raw.stride_bytes);
    auto* const to = reinterpret_cast<Pixel*>(out_.row(y));
    const float* const factor = factor_.data() + static_cast<std::ptrdiff_t>(y) * width;
    const float* const less = less_.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int x = 0; x < width; ++x) {
      const float count = static_cast<float>(from[x]);
      const float value = factor[x] * count - less[x] + to_nearest;
      const float shown =
          count < full_scale ? std::min(std::max(value, 0.0F), highest) : full_scale;
      to[x] = static_cast<Pixel>(static_cast<int>(shown));
    }
  }
}

bool FixedPattern::look(const FrameView& raw) {
  if (!learner_.look(raw, map_factor_, map_less_)) return false;
  static_share_ = learner_.static_share();
  return apply_what_was_learned();
}

/// True when something changed. Of a dirty pixel: (count - own light) / share.
bool FixedPattern::apply_what_was_learned() {
  bool changed = false;
  for (std::size_t i = 0; i < factor_.size(); ++i) {
    float factor = map_factor_[i];
    float less = map_less_[i];
    const PatternLearner::PixelKind kind = learner_.kind(i);
    if (kind == PatternLearner::PixelKind::dirty) {
      factor /= learner_.share(i);
      less = (less + learner_.own_counts(i)) / learner_.share(i);
    }
    const bool is_hole = map_holes_[i] != 0 || kind == PatternLearner::PixelKind::hole;
    const auto hole = static_cast<std::uint8_t>(is_hole ? 1 : 0);
    changed = changed || factor != factor_[i] || less != less_[i] || hole != holes_[i];
    factor_[i] = factor;
    less_[i] = less;
    holes_[i] = hole;
  }
  if (!changed) return false;
  corrects_ = true;
  filler_.set(holes_);
  return true;
}

}  // namespace lsv
