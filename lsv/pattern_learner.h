// SPDX-License-Identifier: BSD-3-Clause
// What of an image does not move with the ground: dirt on the optics, uneven light, borders.
//
// Over many places of the ground, each pixel of a clean and evenly lit sensor has the same mean and
// the same spread. A pixel whose mean or spread differs by more than chance has light of its own
// and lets a share of the pattern through. Where most of the image seems static the ground itself
// may be: nothing is learned.
//
// Owns its memory, allocates at construction only; one object per thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lsv/core/frame.h"

namespace lsv {

class PatternLearner {
 public:
  enum class PixelKind : std::uint8_t {
    clean,
    dirty,  // shows the ground through something
    hole,   // shows nothing of it, or it is not known yet how much
  };

  PatternLearner() = default;
  /// `known_holes`, row-major, not 0 where a pixel is a hole anyhow, or empty.
  PatternLearner(const FrameFormat& format, std::vector<std::uint8_t> known_holes);

  bool learns() const { return !sum_.empty(); }

  /// Ground that was not looked at before; a count of it is factor * raw - less, above the dark
  /// level. True when what is said below may have changed.
  bool look(const FrameView& raw, const std::vector<float>& factor, const std::vector<float>& less);

  PixelKind kind(std::size_t i) const { return kind_[i]; }
  /// Of a dirty pixel: counts that it adds, and the share of the pattern that it passes, > 0.
  float own_counts(std::size_t i) const { return mean_[i] - clean_mean_counts_ * share(i); }
  float share(std::size_t i) const { return spread_[i] / clean_spread_counts_; }

  /// Share of the pixels in which the fixed part outweighs the moving one; NaN until enough was
  /// seen.
  double static_share() const { return static_share_; }

 private:
  bool is_other_light(const FrameView& raw, const std::vector<float>& factor,
                      const std::vector<float>& less);
  template <typename Pixel>
  float mean_of_some(const FrameView& raw, const std::vector<float>& factor,
                     const std::vector<float>& less) const;
  template <typename Pixel>
  void accumulate(const FrameView& raw, const std::vector<float>& factor,
                  const std::vector<float>& less);
  bool judge();
  void measure_pixels();
  float clean_level(const std::vector<float>& values);
  float deviation(std::size_t i) const;
  void mark_what_stands_out();
  void mark_around(int x, int y);
  void smooth(const std::vector<float>& values, std::vector<float>& out);
  void rely_on_neighbours();
  std::size_t count_outweighed() const;
  void forget();

  FrameFormat format_;
  std::vector<std::uint8_t> known_holes_;
  std::vector<float> sum_;  // over the looks
  std::vector<float> sum_squares_;
  std::vector<float> mean_;
  std::vector<float> spread_;
  std::vector<float> sorted_;  // scratch
  std::vector<float> mean_around_;
  std::vector<float> spread_around_;
  std::vector<double> sum_to_;  // scratch: over all pixels above and to the left
  std::vector<PixelKind> kind_;
  int looks_ = 0;
  float light_counts_ = 0.0F;  // mean of the first of them
  int other_light_looks_ = 0;  // in a row
  int next_judgement_ = 0;
  float clean_mean_counts_ = 0.0F;
  float clean_spread_counts_ = 1.0F;
  double static_share_ = 0.0;
};

}  // namespace lsv
