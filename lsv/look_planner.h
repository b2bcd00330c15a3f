// SPDX-License-Identifier: BSD-3-Clause
// Which frames show ground that was not looked at before, so that each counts as a look of its own
// at what does not move with the ground (fixed_pattern.h).
//
// As long as the measured motion explains the frames, a new place is one that is away from all
// places looked at. Where the pattern changes more than that (it boils, or what stays on the sensor
// holds the measured motion back), places tell nothing; then a frame counts once it differs from
// each of the last ones looked at about as much as unrelated frames do. The last one alone
// would not do: a vehicle that rocks comes back to the same ground again and again.
//
// Owns its memory, allocates at construction only; one object per thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lsv/core/frame.h"

namespace lsv {

class LookPlanner {
 public:
  explicit LookPlanner(const FrameFormat& format);

  /// To be asked about every frame in turn; a frame that is due must be looked at.
  /// `apart_px`: two places of the ground that are further apart share no speckle.
  bool is_due(double x_px, double y_px, double apart_px);
  /// The same where the motion does not explain `raw`.
  bool is_due_by_change(const FrameView& raw);

  std::size_t looks() const { return looks_; }

 private:
  struct Place {
    double x_px = 0.0, y_px = 0.0;
  };
  bool waits();
  bool look();
  void take_samples(const FrameView& raw);
  double squared_difference(const std::vector<std::uint16_t>& earlier) const;

  std::array<Place, 1024> places_{};  // in turn
  std::size_t place_count_ = 0;
  std::size_t looks_ = 0;
  int frames_since_look_ = 0;
  int sample_step_px_ = 1;
  std::vector<std::uint16_t> samples_;                 // of the frame in question
  std::array<std::vector<std::uint16_t>, 32> seen_{};  // of the frames looked at, in turn
  std::size_t seen_count_ = 0;
  double full_change_ = 0.0;  // squared difference of two unrelated frames, as far as seen
};

}  // namespace lsv
