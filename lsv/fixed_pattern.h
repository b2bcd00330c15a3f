// SPDX-License-Identifier: BSD-3-Clause
// Whatever stays where it is on the sensor while the ground moves: offset and gain of the pixels,
// known from the calibration, and dirt on the optics or uneven light, learned while driving. Both
// would pull every shift towards zero.
//
// Learning: over many places of the ground, each pixel of a clean and evenly lit sensor has the
// same mean and the same spread. A pixel whose mean or spread differs by more than chance has light
// of its own, o, and lets a part g of the pattern through; the pixel is then read as (count - o) /
// g, or, where g is small or not known yet, as the mean of the clean ones. The rest is left alone
// to the bit. Where most of the image seems static the ground itself may be: nothing is corrected.
//
// Owns its memory, allocates at construction only; one object per thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/core/sensor_maps.h"

namespace lsv {

class FixedPattern {
 public:
  /// For frames of `format` with the maps of `config`. invalid_argument when the maps are of
  /// another size, when the calibration names maps and none are set, or when it is for frames of
  /// another bit depth or for smaller ones.
  static Result<FixedPattern> create(const TrackConfig& config, const FrameFormat& format,
                                     bool learn);

  /// `maps`, if any, have the size of the frames. `dark_counts` is the level that offsets are
  /// brought to. `learn`: whether look() will be called.
  FixedPattern(const FrameFormat& format, double dark_counts, const SensorMaps* maps, bool learn);

  /// `raw` without the fixed pattern, as far as it is known: `raw` itself where nothing is.
  /// Saturated pixels stay saturated unless they always are; others do not become so. Valid until
  /// the next call.
  FrameView corrected(const FrameView& raw);

  bool learns() const { return !sum_.empty(); }
  /// Learns from a frame that shows other ground than the one before. True when what is known has
  /// changed: frames corrected before and after must not be compared.
  bool look(const FrameView& raw);

  /// Share of the pixels in which the fixed part outweighs the moving one; NaN until enough was
  /// seen.
  double static_share() const { return static_share_; }

 private:
  struct Defect {
    std::int32_t at = 0;
    std::int32_t neighbours[4] = {};
    int count = 0;
  };
  template <typename Pixel>
  void correct(const FrameView& raw);
  template <typename Pixel>
  void accumulate(const FrameView& raw);
  void find_defects(const SensorMaps& maps);
  /// Of a clean and evenly lit pixel, over the looks.
  struct Clean {
    float mean_counts;
    float spread_counts;
  };
  bool renew();
  void measure_pixels();
  float clean_level(const std::vector<float>& values);
  void mark_what_stands_out(const Clean& clean);
  std::size_t count_outweighed(const Clean& clean) const;
  bool apply(const Clean& clean);
  void correct_pixel(std::size_t i, const Clean& clean);
  void forget();

  FrameFormat format_;
  float dark_counts_;
  bool corrects_ = false;
  Frame out_;
  // Count of a pixel = factor_ * raw - less_.
  std::vector<float> factor_;
  std::vector<float> less_;
  std::vector<float> map_factor_;  // the part that the calibration knows
  std::vector<float> map_less_;
  std::vector<Defect> defects_;

  std::vector<float> sum_;  // over the looks, per pixel
  std::vector<float> sum_squares_;
  std::vector<float> mean_;  // scratch of renew()
  std::vector<float> spread_;
  std::vector<float> sorted_;
  std::vector<std::uint8_t> stands_out_;
  int looks_ = 0;
  int next_renewal_;
  double static_share_;
};

}  // namespace lsv
