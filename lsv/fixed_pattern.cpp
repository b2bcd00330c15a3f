// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/fixed_pattern.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "lsv/core/shift.h"

namespace lsv {
namespace {

// Eight looks tell which pixels do not change at all, of which chance makes one in a million. What
// is in between, and how much of the pattern it lets through, takes more of them.
constexpr int kFirstRenewal = 8;
constexpr float kStill = 0.04F;  // spread / that of a clean pixel
constexpr int kLooksThatTellShare = 32;
constexpr int kMostLooks = 4096;  // then half of the past is forgotten
// Chance makes one pixel in a million stand out by as much.
constexpr double kSignificantSigmas = 5.0;
// The spread of exponentially distributed intensity after n looks is known to sqrt(2 / n).
constexpr double kSpreadError = 1.4142135623730951;
// Clean pixels are found even where two thirds of the sensor are dirty.
constexpr double kCleanQuantile = 0.7;
// Speckle that moves on changes every pixel by about its mean; less of a change is no other ground.
constexpr float kLeastContrast = 0.2F;
// Beyond, it is more likely that the ground has not moved than that the optics are that dirty.
constexpr double kMostOutweighed = 0.45;
// Around a pixel that stands out; edges are only half dirty.
constexpr int kReach_px = 2;
// Below, too little of the pattern comes through to be worth raising: such pixels show the mean of
// the clean ones.
constexpr float kLeastShare = 0.15F;
// Fixed outweighs moving: spread below this part of a clean one, or light of its own above this
// part.
constexpr float kOutweighed = 0.5F;

/// What the mean of n exponentially distributed intensities of mean and spread 1 deviates from 1 by
/// chance, at kSignificantSigmas (E. B. Wilson and M. M. Hilferty, PNAS 17 (1931) 684).
float chance_deviation(int n, double sigmas) {
  const double ninth = 1.0 / (9.0 * n);
  return static_cast<float>(std::pow(std::max(0.0, 1.0 - ninth + sigmas * std::sqrt(ninth)), 3.0) -
                            1.0);
}

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
      const bool is_clipped = count == full_scale && factor[x] != 0.0F;
      const float to_round_down = kHalf + (is_clipped ? full_scale : value);
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
  next_renewal_ *= 2;
  const bool changed = renew();
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
  measure_pixels();
  const Clean clean{.mean_counts = clean_level(mean_), .spread_counts = clean_level(spread_)};
  if (!(clean.mean_counts > 0.0F) || !(clean.spread_counts > kLeastContrast * clean.mean_counts)) {
    forget();
    return false;
  }
  mark_what_stands_out(clean);
  const auto pixels = static_cast<double>(mean_.size());
  static_share_ = static_cast<double>(count_outweighed(clean)) / pixels;
  if (static_share_ > kMostOutweighed) {
    forget();
    return false;
  }
  return apply(clean);
}

void FixedPattern::measure_pixels() {
  const auto n = static_cast<float>(looks_);
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const float mean = sum_[i] / n;
    const float variance = std::max(sum_squares_[i] / n - mean * mean, 0.0F);
    mean_[i] = map_factor_[i] * mean - map_less_[i] - dark_counts_;
    spread_[i] = map_factor_[i] * std::sqrt(variance);
  }
}

float FixedPattern::clean_level(const std::vector<float>& values) {
  std::copy(values.begin(), values.end(), sorted_.begin());
  const auto at = sorted_.begin() +
                  static_cast<std::ptrdiff_t>(kCleanQuantile * static_cast<double>(values.size()));
  std::nth_element(sorted_.begin(), at, sorted_.end());
  return *at;
}

void FixedPattern::mark_what_stands_out(const Clean& clean) {
  const bool tells_share = looks_ >= kLooksThatTellShare;
  const float highest = clean.spread_counts * chance_deviation(looks_, kSignificantSigmas);
  const float lowest = clean.spread_counts * chance_deviation(looks_, -kSignificantSigmas);
  const auto most_spread = static_cast<float>(
      std::exp(kSignificantSigmas * kSpreadError / std::sqrt(static_cast<double>(looks_))));
  std::fill(stands_out_.begin(), stands_out_.end(), std::uint8_t{0});
  const int width = format_.width_px;
  const int height = format_.height_px;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(y * width + x);
      const float apart = mean_[i] - clean.mean_counts;
      const float ratio = spread_[i] / clean.spread_counts;
      const bool is_clean = tells_share ? apart < highest && apart > lowest &&
                                              ratio < most_spread && ratio * most_spread > 1.0F
                                        : ratio > kStill;
      if (is_clean) continue;
      const int left = std::max(0, x - kReach_px);
      const int right = std::min(width - 1, x + kReach_px);
      for (int v = std::max(0, y - kReach_px); v <= std::min(height - 1, y + kReach_px); ++v)
        std::fill_n(stands_out_.begin() + v * width + left, right - left + 1, std::uint8_t{1});
    }
  }
}

std::size_t FixedPattern::count_outweighed(const Clean& clean) const {
  std::size_t out = 0;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const float share = spread_[i] / clean.spread_counts;
    const float own_counts = mean_[i] - clean.mean_counts * share;
    if (stands_out_[i] != 0 &&
        (share < kOutweighed || std::abs(own_counts) > kOutweighed * clean.mean_counts))
      ++out;
  }
  return out;
}

bool FixedPattern::apply(const Clean& clean) {
  bool changed = false;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const float before_factor = factor_[i];
    const float before_less = less_[i];
    factor_[i] = map_factor_[i];
    less_[i] = map_less_[i];
    if (stands_out_[i] != 0) correct_pixel(i, clean);
    changed = changed || factor_[i] != before_factor || less_[i] != before_less;
  }
  corrects_ = corrects_ || changed;
  return changed;
}

/// raw -> (calibrated count - own light) / share, on the same dark level.
void FixedPattern::correct_pixel(std::size_t i, const Clean& clean) {
  const float share = spread_[i] / clean.spread_counts;
  if (share < kLeastShare || looks_ < kLooksThatTellShare) {
    factor_[i] = 0.0F;
    less_[i] = -(clean.mean_counts + dark_counts_);
    return;
  }
  const float own_counts = mean_[i] - clean.mean_counts * share;
  factor_[i] = map_factor_[i] / share;
  less_[i] = (map_less_[i] + dark_counts_ + own_counts) / share - dark_counts_;
}

void FixedPattern::forget() {
  looks_ = 0;
  next_renewal_ = kFirstRenewal;
  std::fill(sum_.begin(), sum_.end(), 0.0F);
  std::fill(sum_squares_.begin(), sum_squares_.end(), 0.0F);
}

}  // namespace lsv
