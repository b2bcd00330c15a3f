// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/pattern_learner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lsv/core/shift.h"

namespace lsv {
namespace {

// Eight looks tell which pixels do not change at all, of which chance makes one in a million. What
// is in between, and how much of the pattern it lets through, takes more of them.
constexpr int kFirstJudgement = 8;
constexpr float kStill = 0.04F;  // spread / that of a clean pixel
constexpr int kLooksThatTellShare = 32;
// Light that changed by more, for so many looks in a row, is other light.
constexpr float kLightRatio = 1.5F;
constexpr int kOtherLightLooks = 64;
constexpr int kMostLooks = 4096;  // then half of the past is forgotten
// Chance makes one pixel in a hundred million stand out by as much; a million pixels are judged in
// a drive. And beside one that does, these do.
constexpr float kSignificantSigmas = 6.0F;
constexpr float kBesideSigmas = 2.0F;
// Around a pixel that stands out; edges are only half dirty.
constexpr int kReach_px = 2;
// The spread of exponentially distributed intensity after n looks is known to sqrt(2 / n).
constexpr float kSpreadError = 1.4142136F;
// Clean pixels are found even where two thirds of the sensor are dirty.
constexpr double kCleanQuantile = 0.7;
// Speckle that moves on changes every pixel by about its mean; less of a change is no other ground.
constexpr float kLeastContrast = 0.2F;
// Beyond, it is more likely that the ground has not moved than that the optics are that dirty.
constexpr double kMostOutweighed = 0.45;
// Figures of one pixel are known to 1 / sqrt(n) only, those of its surroundings better. A pixel
// that differs from them by z sigmas counts for 1 - kNoise / z^2 (W. James and C. Stein, Proc. 4th
// Berkeley Symp. 1 (1961) 361): of what is chance little is left.
constexpr float kNoise = 3.0F;
constexpr int kAround_px = 6;
// Below, too little of the pattern comes through to be worth raising.
constexpr float kLeastShare = 0.15F;
// Fixed outweighs moving: spread below this part of a clean one, or light of its own above this
// part.
constexpr float kOutweighed = 0.5F;

/// By how many standard deviations the mean of n exponentially distributed intensities of mean 1 is
/// off (E. B. Wilson and M. M. Hilferty, PNAS 17 (1931) 684).
float sigmas_of_mean(float mean_ratio, float n) {
  const float ninth = 1.0F / (9.0F * n);
  return (std::cbrt(std::max(mean_ratio, 0.0F)) - 1.0F + ninth) / std::sqrt(ninth);
}

}  // namespace

PatternLearner::PatternLearner(const FrameFormat& format, std::vector<std::uint8_t> known_holes)
    : format_(format),
      known_holes_(std::move(known_holes)),
      next_judgement_(kFirstJudgement),
      static_share_(kUnknown) {
  const auto pixels =
      static_cast<std::size_t>(format.width_px) * static_cast<std::size_t>(format.height_px);
  known_holes_.resize(pixels, 0);
  for (std::vector<float>* plane :
       {&sum_, &sum_squares_, &mean_, &spread_, &sorted_, &mean_around_, &spread_around_})
    plane->assign(pixels, 0.0F);
  sum_to_.assign(static_cast<std::size_t>(format.width_px + 1) *
                     static_cast<std::size_t>(format.height_px + 1),
                 0.0);
  kind_.assign(pixels, PixelKind::clean);
}

/// Looks of different light do not add up: a few bright ones among many dim ones would pass for
/// many. When the light stays changed learning begins anew.
bool PatternLearner::is_other_light(const FrameView& raw, const std::vector<float>& factor,
                                    const std::vector<float>& less) {
  const float level_counts = format_.type == PixelType::mono8
                                 ? mean_of_some<std::uint8_t>(raw, factor, less)
                                 : mean_of_some<std::uint16_t>(raw, factor, less);
  const bool is_other = looks_ > 0 && !(level_counts > light_counts_ / kLightRatio &&
                                        level_counts < light_counts_ * kLightRatio);
  other_light_looks_ = is_other ? other_light_looks_ + 1 : 0;
  if (is_other && other_light_looks_ < kOtherLightLooks) return true;
  if (is_other) forget();
  if (looks_ == 0) light_counts_ = level_counts;
  return false;
}

bool PatternLearner::look(const FrameView& raw, const std::vector<float>& factor,
                          const std::vector<float>& less) {
  if (is_other_light(raw, factor, less)) return false;
  if (format_.type == PixelType::mono8)
    accumulate<std::uint8_t>(raw, factor, less);
  else
    accumulate<std::uint16_t>(raw, factor, less);
  if (++looks_ < next_judgement_) return false;
  next_judgement_ *= 2;
  const bool judged = judge();
  if (looks_ < kMostLooks) return judged;
  looks_ /= 2;
  next_judgement_ = kMostLooks;
  for (std::vector<float>* plane : {&sum_, &sum_squares_}) {
    for (float& value : *plane) value *= 0.5F;
  }
  return judged;
}

/// Above the dark level, over every fourth row.
template <typename Pixel>
float PatternLearner::mean_of_some(const FrameView& raw, const std::vector<float>& factor,
                                   const std::vector<float>& less) const {
  const auto width = static_cast<std::size_t>(format_.width_px);
  double sum = 0.0;
  double count = 0.0;
  for (int y = 0; y < format_.height_px; y += 4) {
    const auto* const from = reinterpret_cast<const Pixel*>(raw.data + y * raw.stride_bytes);
    const std::size_t row = static_cast<std::size_t>(y) * width;
    float row_sum = 0.0F;
    for (std::size_t x = 0; x < width; ++x)
      row_sum += factor[row + x] * static_cast<float>(from[x]) - less[row + x];
    sum += static_cast<double>(row_sum);
    count += static_cast<double>(width);
  }
  return static_cast<float>(sum / count);
}

template <typename Pixel>
void PatternLearner::accumulate(const FrameView& raw, const std::vector<float>& factor,
                                const std::vector<float>& less) {
  const auto width = static_cast<std::size_t>(format_.width_px);
  for (int y = 0; y < format_.height_px; ++y) {
    const auto* const from = reinterpret_cast<const Pixel*>(raw.data + y * raw.stride_bytes);
    const std::size_t row = static_cast<std::size_t>(y) * width;
    for (std::size_t x = 0; x < width; ++x) {
      const float count = factor[row + x] * static_cast<float>(from[x]) - less[row + x];
      sum_[row + x] += count;
      sum_squares_[row + x] += count * count;
    }
  }
}

/// Compares every pixel with the clean ones.
bool PatternLearner::judge() {
  measure_pixels();
  clean_mean_counts_ = clean_level(mean_);
  clean_spread_counts_ = clean_level(spread_);
  if (!(clean_mean_counts_ > 0.0F) ||
      !(clean_spread_counts_ > kLeastContrast * clean_mean_counts_)) {
    forget();
    return false;
  }
  std::fill(kind_.begin(), kind_.end(), PixelKind::clean);
  mark_what_stands_out();
  rely_on_neighbours();
  const double share = static_cast<double>(count_outweighed()) / static_cast<double>(kind_.size());
  // Before, it is a lower bound: it must not take back what was known.
  if (looks_ >= kLooksThatTellShare || !(share <= static_share_)) static_share_ = share;
  if (share > kMostOutweighed) {
    std::fill(kind_.begin(), kind_.end(), PixelKind::clean);
    forget();
  }
  return true;
}

void PatternLearner::measure_pixels() {
  const auto n = static_cast<float>(looks_);
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    mean_[i] = sum_[i] / n;
    spread_[i] = std::sqrt(std::max(sum_squares_[i] / n - mean_[i] * mean_[i], 0.0F));
  }
}

float PatternLearner::clean_level(const std::vector<float>& values) {
  std::copy(values.begin(), values.end(), sorted_.begin());
  const auto at = sorted_.begin() +
                  static_cast<std::ptrdiff_t>(kCleanQuantile * static_cast<double>(values.size()));
  std::nth_element(sorted_.begin(), at, sorted_.end());
  return *at;
}

/// Of mean or spread, in sigmas of chance.
float PatternLearner::deviation(std::size_t i) const {
  const auto n = static_cast<float>(looks_);
  const float mean_ratio = 1.0F + (mean_[i] - clean_mean_counts_) / clean_spread_counts_;
  const float spread_sigmas = std::log(std::max(share(i), 1e-6F)) * std::sqrt(n) / kSpreadError;
  return std::max(std::abs(sigmas_of_mean(mean_ratio, n)), std::abs(spread_sigmas));
}

void PatternLearner::mark_what_stands_out() {
  const bool tells_share = looks_ >= kLooksThatTellShare;
  const int width = format_.width_px;
  for (std::size_t i = 0; i < kind_.size(); ++i) {
    if (known_holes_[i] != 0) continue;
    if (!tells_share) {
      if (share(i) < kStill) kind_[i] = PixelKind::hole;
    } else if (deviation(i) > kSignificantSigmas) {
      mark_around(static_cast<int>(i) % width, static_cast<int>(i) / width);
    }
  }
}

void PatternLearner::mark_around(int x, int y) {
  const int width = format_.width_px;
  for (int v = std::max(0, y - kReach_px); v <= std::min(format_.height_px - 1, y + kReach_px);
       ++v) {
    for (int u = std::max(0, x - kReach_px); u <= std::min(width - 1, x + kReach_px); ++u) {
      const auto i = static_cast<std::size_t>(v * width + u);
      if (known_holes_[i] != 0 || kind_[i] != PixelKind::clean) continue;
      if (deviation(i) > kBesideSigmas)
        kind_[i] = share(i) < kLeastShare ? PixelKind::hole : PixelKind::dirty;
    }
  }
}

/// Mean over the pixels around each.
void PatternLearner::smooth(const std::vector<float>& values, std::vector<float>& out) {
  const int width = format_.width_px;
  const int height = format_.height_px;
  const auto corner = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width + 1) +
           static_cast<std::size_t>(x);
  };
  std::size_t i = 0;
  for (int y = 0; y < height; ++y) {
    double row = 0.0;
    for (int x = 0; x < width; ++x) {
      row += static_cast<double>(values[i++]);
      sum_to_[corner(x + 1, y + 1)] = sum_to_[corner(x + 1, y)] + row;
    }
  }
  i = 0;
  for (int y = 0; y < height; ++y) {
    const int top = std::max(0, y - kAround_px);
    const int bottom = std::min(height, y + kAround_px + 1);
    for (int x = 0; x < width; ++x) {
      const int left = std::max(0, x - kAround_px);
      const int right = std::min(width, x + kAround_px + 1);
      const double sum = sum_to_[corner(right, bottom)] - sum_to_[corner(left, bottom)] -
                         sum_to_[corner(right, top)] + sum_to_[corner(left, top)];
      out[i++] = static_cast<float>(sum / ((right - left) * (bottom - top)));
    }
  }
}

/// A dirty pixel is corrected by its own figures only as far as they are more than chance.
void PatternLearner::rely_on_neighbours() {
  smooth(mean_, mean_around_);
  smooth(spread_, spread_around_);
  const auto n = static_cast<float>(looks_);
  for (std::size_t i = 0; i < kind_.size(); ++i) {
    if (kind_[i] != PixelKind::dirty) continue;
    const float mean = mean_[i] - mean_around_[i];
    const float spread = spread_[i] - spread_around_[i];
    const float variance = spread_around_[i] * spread_around_[i] / n;
    const float z2 =
        std::max(mean * mean, spread * spread / (kSpreadError * kSpreadError)) / variance;
    const float own_weight = std::max(0.0F, 1.0F - kNoise / z2);
    mean_[i] = mean_around_[i] + own_weight * mean;
    spread_[i] = spread_around_[i] + own_weight * spread;
  }
}

std::size_t PatternLearner::count_outweighed() const {
  std::size_t out = 0;
  for (std::size_t i = 0; i < kind_.size(); ++i) {
    const bool is_outweighed =
        share(i) < kOutweighed || std::abs(own_counts(i)) > kOutweighed * clean_mean_counts_;
    if (kind_[i] != PixelKind::clean && is_outweighed) ++out;
  }
  return out;
}

void PatternLearner::forget() {
  looks_ = 0;
  next_judgement_ = kFirstJudgement;
  std::fill(sum_.begin(), sum_.end(), 0.0F);
  std::fill(sum_squares_.begin(), sum_squares_.end(), 0.0F);
}

}  // namespace lsv
