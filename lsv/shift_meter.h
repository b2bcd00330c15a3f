// SPDX-License-Identifier: BSD-3-Clause
// The shift between two frames, by the preset asked for: a full search for pairs of which nothing
// is known, or a look around a guess. What the keyframe odometry and `lsv shift` have in common.
// Owns its memory, allocates at creation only; one object per thread.
#pragma once

#include "correlation/tracker.h"
#include "lsv/acquisition.h"
#include "lsv/core/config.h"
#include "lsv/core/frame.h"
#include "lsv/core/result.h"

namespace lsv {

class ShiftMeter {
 public:
  /// invalid_argument when a setting is out of range or does not fit the frames, or memory is
  /// short.
  static Result<ShiftMeter> create(const TrackConfig& config, const FrameFormat& format);

  const FrameFormat& format() const { return format_; }
  TrackFrame make_frame() const { return TrackFrame(format_); }
  TrackReference make_reference() const;

  /// ok, dark, saturated or low_contrast.
  ShiftStatus fitness(const TrackFrame& frame) const;
  bool frozen(const TrackFrame& earlier, const TrackFrame& later) const;

  /// See Tracker.
  void set_holes(const std::vector<std::uint8_t>& is_hole) { tracker_.set_holes(is_hole); }

  void build(const TrackFrame& frame, TrackReference& reference) const {
    tracker_.build(frame, reference);
  }

  /// The full search. Frames must be fit. Leaves no trace in what is measured later.
  Shift acquire(const TrackFrame& earlier, const TrackFrame& later);
  /// What the full search of the same frames found, as precisely as the preset asks. `reference`
  /// was built from `earlier`.
  TrackedShift refine(const TrackFrame& earlier, const TrackReference& reference,
                      const TrackFrame& later, const Shift& acquired);
  /// Near a guess. Quality that only a full search can measure (q, peak_ratio, peak_to_rms) is
  /// that of the last one, in proportion to the ZNCC.
  TrackedShift follow(const TrackFrame& earlier, const TrackReference& reference,
                      const TrackFrame& later, double guess_dx_px, double guess_dy_px);

  /// Whether shifts are refused as inconsistent; on unless switched off.
  void set_checks_rows(bool checks_rows) { checks_rows_ = checks_rows; }
  /// What the check says, switched off or not.
  static bool rows_agree(const TrackedShift& tracked);

  /// Full width at half maximum of the speckle, or somewhat more, as far as the preset knows it.
  double speckle_px(const TrackReference& reference) const;

  const LagRange& lags() const { return acquisition_.lags(); }
  /// Of the pair searched last.
  const CorrelationPlane& plane() const { return acquisition_.plane(); }

 private:
  ShiftMeter(const TrackConfig& config, const FrameFormat& format, Acquisition acquisition);
  void take_background(ShiftQuality& quality) const;
  void judge(TrackedShift& tracked) const;

  Preset preset_;
  GateConfig gate_;
  Calibration camera_;
  FrameFormat format_;
  Acquisition acquisition_;
  Tracker tracker_;
  ShiftQuality last_search_;
  bool checks_rows_ = true;
};

}  // namespace lsv
