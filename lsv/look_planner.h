// SPDX-License-Identifier: BSD-3-Clause
// Which frames show ground that was not looked at before, so that each counts as a look of its own
// at what does not move with the ground (fixed_pattern.h).
//
// As long as the measured motion explains the frames, a new place is one that is away from all
// places looked at. Where the pattern changes more than that (it boils, or what stays on the sensor
// holds the measured motion back), places tell nothing; then a frame counts once it differs from
// the last one looked at as much as from the first: all that can change has changed.
//
// Owns its memory, allocates at construction only; one object per thread.
#pragma once

#include <array>
#include <cstddef>

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

  std::array<Place, 1024> places_{};  // in turn
  std::size_t place_count_ = 0;
  std::size_t looks_ = 0;
  int frames_since_look_ = 0;
  bool changing_ = false;
  Frame first_changing_;
  Frame last_changing_;
};

}  // namespace lsv
