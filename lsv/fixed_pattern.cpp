// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/fixed_pattern.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "lsv/core/shift.h"

namespace lsv {
namespace {

constexpr int kFirstRenewal = 32;
constexpr int kMostLooks = 4096;  // then half of the past is forgotten
// Chance makes one pixel in a million stand out by as much.
constexpr double kSignificantSigmas = 5.0;
// The spread of exponentially distributed intensity after n looks is known to sqrt(2 / n).
constexpr double kSpreadError = 1.4142135623730951;
// Clean pixels are found even where two thirds of the sensor are dirty.
constexpr double kCleanQuantile = 0.7;
// Around a pixel that stands out; edges are only half dirty.
constexpr int kReach_px = 2;
// Below, too little light comes through to be worth raising.
constexpr float kLeastShare = 0.15F;
// Fixed outweighs moving: spread below this part of a clean one, or light of its own above this
// part.
constexpr float kOutweighed = 0.5F;

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
    : format_(format),
      dark_counts_(static_cast<float>(dark_counts)),
      next_renewal_(kFirstRenewal),
      static_share_(kUnknown) {
  if (maps == nullptr && !learn) return;
  const auto pixels =
      static_cast<std::size_t>(format.width_px) * static_cast<std::size_t>(format.height_px);
  out_.reset(format);
  map_factor_.assign(pixels, 1.0F);
  map_less_.assign(pixels, 0.0F);
  if (maps != nullptr) {
    corrects_ = true;
    for (std::size_t i = 0; i < pixels; ++i) {
      map_factor_[i] = 1.0F / maps->gain_ratio[i];
      map_less_[i] = maps->offset_counts[i] * map_factor_[i] - dark_counts_;
    }
    find_defects(*maps);
  }
  factor_ = map_factor_;
  less_ = map_less_;
  if (!learn) return;
  for (std::vector<float>* plane : {&sum_, &sum_squares_, &mean_, &spread_, &sorted_})
    plane->assign(pixels, 0.0F);
  stands_out_.assign(pixels, 0);
}

void FixedPattern::find_defects(const SensorMaps& maps) {
  const int width = format_.width_px;
  const int height = format_.height_px;
  const auto good = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height &&
           maps.defect[static_cast<std::size_t>(y * width + x)] == 0;
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (maps.defect[static_cast<std::size_t>(y * width + x)] == 0) continue;
      Defect defect{.at = y * width + x};
      // The nearest good pixel on each side.
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        int reach = 1;
        while (reach < 4 && !good(x + reach * dx, y + reach * dy)) ++reach;
        if (!good(x + reach * dx, y + reach * dy)) continue;
        defect.neighbours[defect.count++] = (y + reach * dy) * width + x + reach * dx;
      }
      defects_.push_back(defect);
    }
  }
}

FrameView FixedPattern::corrected(const FrameView& raw) {
  if (!corrects_) return raw;
  if (format_.type == PixelType::mono8)
    correct<std::uint8_t>(raw);
  else
    correct<std::uint16_t>(raw);
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
  constexpr float kHalf = 0.5F;  // rounds to the nearest, and unlike lround() in vectors
  for (int y = 0; y < format_.height_px; ++y) {
    const auto* const from = reinterpret_cast<const Pixel*>(raw.data + y * raw.stride_bytes);
    auto* const to = reinterpret_cast<Pixel*>(out_.row(y));
    const float* const factor = factor_.data() + static_cast<std::ptrdiff_t>(y) * width;
    const float* const less = less_.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int x = 0; x < width; ++x) {
      const float count = static_cast<float>(from[x]);
      const float value = std::min(std::max(factor[x] * count - less[x], 0.0F), highest);
      const float to_round_down = kHalf + (count < full_scale ? value : full_scale);
      to[x] = static_cast<Pixel>(static_cast<int>(to_round_down));
    }
  }
  const auto pixel_at = [this, width](std::int32_t i) -> Pixel& {
    return reinterpret_cast<Pixel*>(out_.row(i / width))[i % width];
  };
  for (const Defect& defect : defects_) {
    int sum = 0;
    for (int k = 0; k < defect.count; ++k) sum += pixel_at(defect.neighbours[k]);
    if (defect.count > 0)
      pixel_at(defect.at) = static_cast<Pixel>((sum + defect.count / 2) / defect.count);
  }
}

bool FixedPattern::look(const FrameView& raw) {
  if (format_.type == PixelType::mono8)
    accumulate<std::uint8_t>(raw);
  else
    accumulate<std::uint16_t>(raw);
  if (++looks_ < next_renewal_) return false;
  const bool changed = renew();
  next_renewal_ *= 2;
  if (looks_ < kMostLooks) return changed;
  looks_ /= 2;
  next_renewal_ = kMostLooks;
  for (std::vector<float>* plane : {&sum_, &sum_squares_}) {
    for (float& value : *plane) value *= 0.5F;
  }
  return changed;
}

template <typename Pixel>
void FixedPattern::accumulate(const FrameView& raw) {
  const int width = format_.width_px;
  for (int y = 0; y < format_.height_px; ++y) {
    const auto* const from = reinterpret_cast<const Pixel*>(raw.data + y * raw.stride_bytes);
    float* const sum = sum_.data() + static_cast<std::ptrdiff_t>(y) * width;
    float* const squares = sum_squares_.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int x = 0; x < width; ++x) {
      const float count = static_cast<float>(from[x]);
      sum[x] += count;
      squares[x] += count * count;
    }
  }
}

/// Compares every pixel with the clean ones; true when factor_ or less_ changed.
bool FixedPattern::renew() {
  const auto n = static_cast<float>(looks_);
  const std::size_t pixels = sum_.size();
  for (std::size_t i = 0; i < pixels; ++i) {
    const float mean = sum_[i] / n;
    const float variance = std::max(sum_squares_[i] / n - mean * mean, 0.0F);
    mean_[i] = map_factor_[i] * mean - map_less_[i] - dark_counts_;
    spread_[i] = map_factor_[i] * std::sqrt(variance);
  }
  const auto quantile = [&](const std::vector<float>& values) {
    std::copy(values.begin(), values.end(), sorted_.begin());
    const auto at =
        sorted_.begin() + static_cast<std::ptrdiff_t>(kCleanQuantile * static_cast<double>(pixels));
    std::nth_element(sorted_.begin(), at, sorted_.end());
    return *at;
  };
  const float clean_mean = quantile(mean_);
  const float clean_spread = quantile(spread_);
  if (!(clean_spread > 0.0F) || !(clean_mean > 0.0F)) return false;

  const double root_n = std::sqrt(static_cast<double>(looks_));
  const auto most_mean = static_cast<float>(kSignificantSigmas / root_n) * clean_spread;
  const auto most_spread = static_cast<float>(std::exp(kSignificantSigmas * kSpreadError / root_n));
  std::fill(stands_out_.begin(), stands_out_.end(), std::uint8_t{0});
  const int width = format_.width_px;
  const int height = format_.height_px;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(y * width + x);
      const float ratio = spread_[i] / clean_spread;
      const bool stands_out = std::abs(mean_[i] - clean_mean) > most_mean || ratio > most_spread ||
                              ratio * most_spread < 1.0F;
      if (!stands_out) continue;
      for (int v = std::max(0, y - kReach_px); v <= std::min(height - 1, y + kReach_px); ++v)
        std::fill_n(stands_out_.begin() + v * width + std::max(0, x - kReach_px),
                    std::min(width - 1, x + kReach_px) - std::max(0, x - kReach_px) + 1,
                    std::uint8_t{1});
    }
  }

  std::size_t outweighed = 0;
  bool changed = false;
  for (std::size_t i = 0; i < pixels; ++i) {
    const float before_factor = factor_[i];
    const float before_less = less_[i];
    factor_[i] = map_factor_[i];
    less_[i] = map_less_[i];
    if (stands_out_[i] != 0) {
      const float share = std::max(spread_[i] / clean_spread, kLeastShare);
      const float own_counts = mean_[i] - clean_mean * share;
      learn_pixel(i, own_counts, share);
      if (share < kOutweighed || std::abs(own_counts) > kOutweighed * clean_mean) ++outweighed;
    }
    changed = changed || factor_[i] != before_factor || less_[i] != before_less;
  }
  static_share_ = static_cast<double>(outweighed) / static_cast<double>(pixels);
  corrects_ = corrects_ || changed;
  return changed;
}

/// raw -> (calibrated count - own light) / share, on the same dark level.
void FixedPattern::learn_pixel(std::size_t i, float own_counts, float share) {
  const float raise = 1.0F / share;
  factor_[i] = map_factor_[i] * raise;
  less_[i] = (map_less_[i] + dark_counts_ + own_counts) * raise - dark_counts_;
}

}  // namespace lsv
