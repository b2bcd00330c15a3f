// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/keyframe_odometry.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lsv/gate.h"

namespace lsv {
namespace {

ShiftCovariance weighted_sum(const ShiftCovariance& a, double wa, const ShiftCovariance& b,
                             double wb) {
  return {wa * a.xx_px2 + wb * b.xx_px2, wa * a.xy_px2 + wb * b.xy_px2,
          wa * a.yy_px2 + wb * b.yy_px2};
}

double trace(const ShiftCovariance& cov) { return cov.xx_px2 + cov.yy_px2; }

// Pattern within this distance, or 5 sigma, for this many frames: at rest.
constexpr double kRestRadius_px = 0.01;
constexpr double kRestSigmas = 5.0;
constexpr int kRestFrames = 50;

// Places of the ground that share no speckle are further apart than a speckle is wide, and than
// this.
constexpr double kApart_px = 4.0;
// From this share of change on, the motion does not explain the frame.
constexpr double kUnexplained = 0.02;
// Once the optics were looked at that often they are known, and what stands still is at rest.
constexpr std::size_t kLooksThatTell = 32;
constexpr double kStandstill_px = 1.5;
// Beyond so many speckles what stays no longer resembles itself.
constexpr double kSpecklesApart = 1.5;
// That many frames without a match are no passing disturbance.
constexpr int kLostFrames = 4;

// As many torn frames, one after the other, are no accident but what frames look like now: rows
// that something on the optics hides, say. Rows are checked again once they have agreed for a
// while.
constexpr int kTornFrames = 10;
constexpr int kWholeFrames = 50;

// Beyond, a keyframe is given up whatever the errors say.
constexpr double kMaxKeyframeShift = 0.5;  // of the side of the frame
constexpr double kMinKeyframeZncc = 0.5;

}  // namespace

KeyframeOdometry::KeyframeOdometry(ShiftMeter meter, FixedPattern fixed_pattern,
                                   std::optional<DeformationMeter> deformation)
    : meter_(std::move(meter)),
      fixed_pattern_(std::move(fixed_pattern)),
      deformation_(std::move(deformation)),
      reference_(meter_.make_reference()),
      look_planner_(meter_.format()) {
  for (Slot& slot : slots_) slot.frame = meter_.make_frame();
  if (!fixed_pattern_.holes().empty()) meter_.set_holes(fixed_pattern_.holes());
}

KeyframeOdometry::SlotIndex KeyframeOdometry::free_slot() const {
  for (SlotIndex i = 0; i < slots_.size(); ++i) {
    if (i != keyframe_ && i != last_ && i != before_ && i != doubtful_) return i;
  }
  return 0;  // four names, five slots
}

PatternStep KeyframeOdometry::step(const FrameView& frame) {
  const SlotIndex now = free_slot();
  raw_ = frame;
  is_torn_ = false;
  slots_[now].frame.load(fixed_pattern_.corrected(frame));
  slots_[now].stamp = frame.stamp;
  slots_[now].index = frame.index;
  shown_plane_.reset();

  const ShiftStatus fitness = meter_.fitness(slots_[now].frame);
  if (fitness != ShiftStatus::ok) {
    const bool is_first = !last_ && last_unfit_ == ShiftStatus::first_frame;
    last_unfit_ = fitness;
    wanted_plane_.reset();
    return refused(now, is_first ? ShiftStatus::first_frame : fitness, {});
  }
  if (!last_) return first(now);
  // A stuck ring of buffers hands out older frames, too.
  for (const std::optional<SlotIndex>& earlier : {last_, doubtful_, before_, keyframe_}) {
    if (earlier && meter_.frozen(slots_[*earlier].frame, slots_[now].frame))
      return refused(now, ShiftStatus::frozen, {});
  }
  if (has_speed_) {
    if (std::optional<PatternStep> followed = follow(now)) return *followed;
  }
  return search(now);
}

PatternStep KeyframeOdometry::first(SlotIndex now) {
  // What came before could not be used: its reason stands for the shift that is missing.
  PatternStep out = refused(now, last_unfit_, {});
  last_ = now;
  set_keyframe(now, {});
  out.keyframe = slots_[now].index;
  return out;
}

PatternStep KeyframeOdometry::refused(SlotIndex now, ShiftStatus status,
                                      const ShiftQuality& quality) {
  PatternStep out;
  out.shift.status = status;
  out.shift.quality = quality;
  out.since = slots_[last_.value_or(now)].stamp;
  out.keyframe = keyframe_ ? slots_[*keyframe_].index : -1;
  out.segment = segment_;
  out.static_share = fixed_pattern_.static_share();
  out.x_px = last_place_.x_px;
  out.y_px = last_place_.y_px;
  out.position_cov = last_place_.cov;
  return out;
}

std::optional<PatternStep> KeyframeOdometry::follow(SlotIndex now) {
  const auto dt_ns = static_cast<double>(slots_[now].stamp.ns - slots_[*last_].stamp.ns);
  const TrackedShift tracked =
      meter_.follow(slots_[*keyframe_].frame, reference_, slots_[now].frame,
                    last_place_.x_px - key_place_.x_px + vx_px_per_ns_ * dt_ns,
                    last_place_.y_px - key_place_.y_px + vy_px_per_ns_ * dt_ns);
  is_torn_ = tracked.shift.status == ShiftStatus::inconsistent;
  if (tracked.shift.status != ShiftStatus::ok) return std::nullopt;
  const double dx_px = key_place_.x_px + tracked.shift.dx_px - last_place_.x_px;
  const double dy_px = key_place_.y_px + tracked.shift.dy_px - last_place_.y_px;
  if (may_be_held_back(tracked, dx_px, dy_px)) {
    const Shift searched = acquire(*last_, now);
    if (searched.status == ShiftStatus::static_pattern) return lost(now, searched);
  }
  return accept(now, tracked, Search::predicted);
}

PatternStep KeyframeOdometry::search(SlotIndex now) {
  // The last accepted frame is nearer than the keyframe: more of it is still in view.
  if (keyframe_ != last_) {
    set_keyframe(*last_, last_place_);
    if (has_speed_) {
      if (std::optional<PatternStep> followed = follow(now)) return *followed;
    }
  }
  Shift judged = acquire(*last_, now);
  if (judged.status == ShiftStatus::ok) {
    const TrackedShift found =
        meter_.refine(slots_[*last_].frame, reference_, slots_[now].frame, judged);
    if (found.shift.status == ShiftStatus::ok) return accept(now, found, Search::full_range);
    judged = found.shift;
  }
  if (is_torn_ || judged.status == ShiftStatus::inconsistent) {
    if (std::optional<PatternStep> refused_torn = torn(now, judged)) return *refused_torn;
  }
  if (std::optional<PatternStep> begun = begin_segment(now)) return *begun;
  return lost(now, judged);
}

PatternStep KeyframeOdometry::lost(SlotIndex now, const Shift& judged) {
  doubtful_ = now;
  wanted_plane_ = {*last_, now};
  const PatternStep out = refused(now, judged.status, judged.quality);
  learn_while_lost(now);
  return out;
}

/// A torn frame leaves no trace: nothing is matched with it and nothing is learned from it. Nothing
/// when frames are torn for good; what is moving can only be found among themselves, then.
std::optional<PatternStep> KeyframeOdometry::torn(SlotIndex now, const Shift& judged) {
  if (++frames_torn_ > kTornFrames) {
    checks_rows_ = false;
    frames_whole_ = 0;
    meter_.set_checks_rows(false);
    return std::nullopt;
  }
  if (frames_torn_ == kTornFrames) doubtful_ = now;
  wanted_plane_ = {*last_, now};
  return refused(now, ShiftStatus::inconsistent, judged.quality);
}

void KeyframeOdometry::trust_rows_again(const TrackedShift& tracked) {
  frames_torn_ = 0;
  if (checks_rows_) return;
  frames_whole_ = ShiftMeter::rows_agree(tracked) ? frames_whole_ + 1 : 0;
  checks_rows_ = frames_whole_ >= kWholeFrames;
  meter_.set_checks_rows(checks_rows_);
}

void KeyframeOdometry::begin_segment_at(SlotIndex slot) {
  last_ = slot;
  before_.reset();
  doubtful_.reset();
  set_keyframe(slot, last_place_);
  has_speed_ = false;
  frames_near_rest_place_ = 0;
  motion_ = MotionState::unknown;
  ++segment_;
}

Shift KeyframeOdometry::acquire(SlotIndex earlier, SlotIndex later) {
  shown_plane_ = {earlier, later};
  return meter_.acquire(slots_[earlier].frame, slots_[later].frame);
}

/// At the doubtful frame, if it shows the ground of the new one.
std::optional<PatternStep> KeyframeOdometry::begin_segment(SlotIndex now) {
  if (!doubtful_) return std::nullopt;
  const Shift acquired = acquire(*doubtful_, now);
  if (acquired.status != ShiftStatus::ok) return std::nullopt;
  begin_segment_at(*doubtful_);
  const TrackedShift found =
      meter_.refine(slots_[*last_].frame, reference_, slots_[now].frame, acquired);
  if (found.shift.status != ShiftStatus::ok) return std::nullopt;
  return accept(now, found, Search::full_range);
}

PatternStep KeyframeOdometry::accept(SlotIndex now, const TrackedShift& tracked, Search search) {
  const auto dt_ns = static_cast<double>(slots_[now].stamp.ns - slots_[*last_].stamp.ns);
  ++steps_since_keyframe_;
  const Shift& measured = tracked.shift;
  Place place{.x_px = key_place_.x_px + measured.dx_px,
              .y_px = key_place_.y_px + measured.dy_px,
              .cov = weighted_sum(key_place_.cov, 1.0, measured.cov, 1.0),
              .noise_cov = tracked.noise_cov,
              .boiling_cov = tracked.boiling_cov,
              .refined = tracked.refined};

  PatternStep out;
  out.shift = measured;
  out.shift.dx_px = place.x_px - last_place_.x_px;
  out.shift.dy_px = place.y_px - last_place_.y_px;
  if (keyframe_ != last_) {
    // Half of the noise of either shift is the keyframe's and cancels; the pattern has boiled
    // since the last frame by one step of many.
    const ShiftCovariance noise =
        place.refined && last_place_.refined
            ? weighted_sum(place.noise_cov, 0.5, last_place_.noise_cov, 0.5)
            : weighted_sum(place.noise_cov, 1.0, last_place_.noise_cov, 1.0);
    out.shift.cov = weighted_sum(noise, 1.0, place.boiling_cov, 1.0 / steps_since_keyframe_);
  }
  out.since = slots_[*last_].stamp;
  out.search = search;
  out.keyframe = slots_[*keyframe_].index;
  out.segment = segment_;
  out.x_px = place.x_px;
  out.y_px = place.y_px;
  out.position_cov = place.cov;

  if (deformation_)
    out.deformation = deformation_->measure(slots_[*last_].frame, slots_[now].frame,
                                            out.shift.dx_px, out.shift.dy_px);

  vx_px_per_ns_ = out.shift.dx_px / dt_ns;
  vy_px_per_ns_ = out.shift.dy_px / dt_ns;
  has_speed_ = true;
  last_unfit_ = ShiftStatus::ok;
  const double dx_px = out.shift.dx_px;
  const double dy_px = out.shift.dy_px;
  before_ = last_;
  last_ = now;
  wanted_plane_ = {*before_, now};
  last_place_ = place;
  doubtful_.reset();
  frames_lost_ = 0;
  trust_rows_again(tracked);
  out.motion = motion_at(place);
  if (learn_fixed_pattern(now, tracked, place) || wants_keyframe(tracked, dx_px, dy_px))
    set_keyframe(now, place);
  out.static_share = fixed_pattern_.static_share();
  return out;
}

/// Whether the pattern changes at standstill while the optics are not known yet: either it boils or
/// dirt on them outweighs the ground, which then shows as a second peak of the full search.
bool KeyframeOdometry::may_be_held_back(const TrackedShift& tracked, double dx_px,
                                        double dy_px) const {
  return fixed_pattern_.learns() && look_planner_.looks() < kLooksThatTell &&
         tracked.boiling_ratio > kUnexplained &&
         std::max(std::abs(dx_px), std::abs(dy_px)) < kStandstill_px;
}

/// True when the frame had to be corrected anew, and so must be the keyframe of those to come.
bool KeyframeOdometry::learn_fixed_pattern(SlotIndex now, const TrackedShift& tracked,
                                           const Place& place) {
  if (!fixed_pattern_.learns()) return false;
  const double apart_px = std::max(kApart_px, meter_.speckle_px(reference_));
  const bool is_due = tracked.boiling_ratio > kUnexplained
                          ? look_planner_.is_due_by_change(raw_)
                          : look_planner_.is_due(place.x_px, place.y_px, apart_px);
  return is_due && look(now);
}

/// The optics may be why nothing matches. Frames corrected before and after do not match either, so
/// the next segment begins at this one.
void KeyframeOdometry::learn_while_lost(SlotIndex now) {
  if (!fixed_pattern_.learns() || ++frames_lost_ < kLostFrames) return;
  if (look_planner_.is_due_by_change(raw_) && look(now)) begin_segment_at(now);
}

/// True when the frame has been corrected anew.
bool KeyframeOdometry::look(SlotIndex now) {
  if (!fixed_pattern_.look(raw_)) return false;
  meter_.set_holes(fixed_pattern_.holes());
  slots_[now].frame.load(fixed_pattern_.corrected(raw_));
  return true;
}

/// Rest is a matter of time as well as of distance: whoever creeps leaves the place in the end.
MotionState KeyframeOdometry::motion_at(const Place& place) {
  const double variance_px2 = std::max(trace(place.cov) - trace(rest_place_.cov), 0.0) +
                              trace(place.noise_cov) + trace(place.boiling_cov);
  const double radius_px = std::max(kRestRadius_px, kRestSigmas * std::sqrt(variance_px2));
  const double distance_px =
      std::hypot(place.x_px - rest_place_.x_px, place.y_px - rest_place_.y_px);
  if (distance_px > radius_px) {
    rest_place_ = place;
    frames_near_rest_place_ = 0;
    return motion_ = MotionState::moving;
  }
  if (++frames_near_rest_place_ >= kRestFrames) motion_ = MotionState::at_rest;
  return motion_;
}

void KeyframeOdometry::set_keyframe(SlotIndex slot, const Place& place) {
  keyframe_ = slot;
  key_place_ = place;
  steps_since_keyframe_ = 0;
  meter_.build(slots_[slot].frame, reference_);
}

/// What stays on the sensor looks like change of the pattern, which calls for a new keyframe, and
/// pulls most over distances of less than a speckle. Until it is known keyframes last longer; where
/// the pattern does change that costs little, since one long link errs about as much as many short
/// ones.
bool KeyframeOdometry::keeps_off_what_stays(double distance_px) const {
  return fixed_pattern_.learns() && look_planner_.looks() < kLooksThatTell &&
         motion_ != MotionState::at_rest &&
         distance_px < kSpecklesApart * meter_.speckle_px(reference_);
}

/// Whether another frame on this keyframe would raise the error per frame: the variance of one
/// link of the chain, divided by the frames that it spans, has its minimum here.
bool KeyframeOdometry::wants_keyframe(const TrackedShift& tracked, double dx_px,
                                      double dy_px) const {
  const FrameFormat& format = meter_.format();
  const auto share = [](double shift_px, int side_px) {
    return 1.0 - std::abs(shift_px) / side_px;
  };
  const double sx_px = last_place_.x_px - key_place_.x_px;
  const double sy_px = last_place_.y_px - key_place_.y_px;
  const double next_x = share(sx_px + dx_px, format.width_px);
  const double next_y = share(sy_px + dy_px, format.height_px);
  if (std::min(next_x, next_y) < 1.0 - kMaxKeyframeShift) return true;
  if (tracked.shift.quality.zncc < kMinKeyframeZncc) return true;
  if (keeps_off_what_stays(std::hypot(sx_px + dx_px, sy_px + dy_px))) return false;

  const double steps = steps_since_keyframe_;
  const double overlap_ratio =
      share(sx_px, format.width_px) * share(sy_px, format.height_px) / (next_x * next_y);
  // The correlation of the pattern falls by the same factor at every step.
  const double ratio = tracked.boiling_ratio;
  const double boiling_growth = ratio > 1e-9
                                    ? (std::pow(1.0 + ratio, (steps + 1.0) / steps) - 1.0) / ratio
                                    : (steps + 1.0) / steps;
  const double noise = trace(tracked.noise_cov);
  const double boiling = trace(tracked.boiling_cov);
  const double per_step = (noise + boiling) / steps;
  const double next_per_step = (noise * overlap_ratio + boiling * boiling_growth) / (steps + 1.0);
  return next_per_step > per_step;
}

const CorrelationPlane& KeyframeOdometry::plane() {
  if (wanted_plane_ && shown_plane_ != wanted_plane_)
    (void)acquire(wanted_plane_->first, wanted_plane_->second);
  return meter_.plane();
}

}  // namespace lsv
