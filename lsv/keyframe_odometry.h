// SPDX-License-Identifier: BSD-3-Clause
// Motion of the pattern against keyframes. Every frame is measured against one earlier frame, the
// keyframe, as long as that gives the smallest error per frame; so the error of the position grows
// with the number of keyframes, not of frames, and at rest not at all.
//
//   predict from the last speed, over gaps too -> follow -> gate -> or else search the full range
//     -> shift since the last accepted frame, position -> is it time for a new keyframe?
//
// The shift of a frame is the difference between two positions against the same keyframe: both
// ways of measuring agree by construction, and what the two share of the keyframe's noise is not
// counted twice. When the pattern is lost, nothing is added: the next frame that shows the ground
// of the last accepted one bridges the gap with a measured shift; if only frames after the gap
// match each other, a new segment begins at the position held.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "lsv/core/frame.h"
#include "lsv/core/step_report.h"
#include "lsv/deformation_meter.h"
#include "lsv/fixed_pattern.h"
#include "lsv/look_planner.h"
#include "lsv/pattern_step.h"
#include "lsv/shift_meter.h"

namespace lsv {

class KeyframeOdometry {
 public:
  /// With a deformation meter, rotation and expansion since the last accepted frame are measured
  /// too.
  KeyframeOdometry(ShiftMeter meter, FixedPattern fixed_pattern,
                   std::optional<DeformationMeter> deformation);

  /// `frame` must have the format of the meter and a later stamp than the one before.
  PatternStep step(const FrameView& frame);

  const LagRange& lags() const { return meter_.lags(); }
  /// Between the frame pushed last and the accepted one before it; correlates them when a search
  /// has not just done so.
  const CorrelationPlane& plane();

 private:
  struct Slot {
    TrackFrame frame;
    Stamp stamp{};
    std::int64_t index = 0;
  };
  /// A place on the path, with what is needed to subtract two of them.
  struct Place {
    double x_px = 0.0, y_px = 0.0;
    ShiftCovariance cov{0.0, 0.0, 0.0};          // since the start of the segment's path
    ShiftCovariance noise_cov{0.0, 0.0, 0.0};    // of the shift against the keyframe
    ShiftCovariance boiling_cov{0.0, 0.0, 0.0};  // of the same
    bool refined = false;                        // see TrackedShift
  };
  using SlotIndex = std::size_t;

  PatternStep first(SlotIndex now);
  PatternStep refused(SlotIndex now, ShiftStatus status, const ShiftQuality& quality);
  PatternStep accept(SlotIndex now, const TrackedShift& tracked, Search search);
  std::optional<PatternStep> follow(SlotIndex now);
  PatternStep search(SlotIndex now);
  PatternStep lost(SlotIndex now, const Shift& judged);
  std::optional<PatternStep> torn(SlotIndex now, const Shift& judged);
  void trust_rows_again(const TrackedShift& tracked);
  std::optional<PatternStep> begin_segment(SlotIndex now);
  void begin_segment_at(SlotIndex slot);
  Shift acquire(SlotIndex earlier, SlotIndex later);
  void set_keyframe(SlotIndex slot, const Place& place);
  bool wants_keyframe(const TrackedShift& tracked, double dx_px, double dy_px) const;
  bool keeps_off_what_stays(double distance_px) const;
  MotionState motion_at(const Place& place);
  bool may_be_held_back(const TrackedShift& tracked, double dx_px, double dy_px) const;
  bool learn_fixed_pattern(SlotIndex now, const TrackedShift& tracked, const Place& place);
  void learn_while_lost(SlotIndex now);
  bool look(SlotIndex now);
  SlotIndex free_slot() const;

  ShiftMeter meter_;
  FixedPattern fixed_pattern_;
  std::optional<DeformationMeter> deformation_;
  std::array<Slot, 5> slots_;
  TrackReference reference_;
  std::optional<SlotIndex> keyframe_;
  std::optional<SlotIndex> last_;      // the last accepted frame
  std::optional<SlotIndex> before_;    // the one accepted before it
  std::optional<SlotIndex> doubtful_;  // a fit frame that matched nothing
  ShiftStatus last_unfit_ = ShiftStatus::first_frame;

  Place key_place_;
  Place last_place_;
  Place rest_place_;  // where the pattern was when it came to rest
  FrameView raw_;     // the frame being measured, as it came
  LookPlanner look_planner_;
  int frames_lost_ = 0;   // fit frames since the last accepted one
  bool is_torn_ = false;  // the frame at hand
  int frames_torn_ = 0;   // one after the other
  bool checks_rows_ = true;
  int frames_whole_ = 0;  // one after the other, while rows are not checked
  int steps_since_keyframe_ = 0;
  int frames_near_rest_place_ = 0;
  MotionState motion_ = MotionState::unknown;
  std::int64_t segment_ = 0;
  bool has_speed_ = false;
  using Pair = std::pair<SlotIndex, SlotIndex>;
  std::optional<Pair> wanted_plane_;  // the pair that the last frame was judged by
  std::optional<Pair> shown_plane_;   // the pair correlated last
  double vx_px_per_ns_ = 0.0;
  double vy_px_per_ns_ = 0.0;
};

}  // namespace lsv
