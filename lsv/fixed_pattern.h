// SPDX-License-Identifier: BSD-3-Clause
// Takes whatever stays where it is on the sensor while the ground moves out of the frames: offset,
// gain and defects of the pixels, known from the calibration, and dirt on the optics or uneven
// light, learned while driving (pattern_learner.h). Both would pull every shift towards zero.
// Pixels of which nothing is known are left alone to the bit.
//
// Owns its memory, allocates at construction only; one object per thread.
#pragma once

#include <cstdint>
#include <vector>

#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/core/sensor_maps.h"
#include "lsv/hole_filler.h"
#include "lsv/pattern_learner.h"

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

  /// Pixels that show nothing of the ground and were filled in, row-major, not 0 where they are;
  /// empty where nothing is corrected at all.
  const std::vector<std::uint8_t>& holes() const { return holes_; }

  bool learns() const { return learner_.learns(); }
  /// Learns from a frame that shows other ground than the one before. True when what is known has
  /// changed: frames corrected before and after must not be compared.
  bool look(const FrameView& raw);

  /// See PatternLearner.
  double static_share() const { return static_share_; }

 private:
  template <typename Pixel>
  void correct(const FrameView& raw);
  bool apply_what_was_learned();

  FrameFormat format_;
  float dark_counts_;
  bool corrects_ = false;
  Frame out_;
  // Count of a pixel above the dark level = factor_ * raw - less_.
  std::vector<float> factor_;
  std::vector<float> less_;
  std::vector<float> map_factor_;  // the part that the calibration knows
  std::vector<float> map_less_;
  std::vector<std::uint8_t> map_holes_;
  std::vector<std::uint8_t> holes_;
  HoleFiller filler_;
  PatternLearner learner_;
  double static_share_;
};

}  // namespace lsv
