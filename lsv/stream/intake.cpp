// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/stream/intake.h"

#include <algorithm>
#include <cmath>

namespace lsv {
namespace {

// Differences of stamps below this cannot overflow; 146 years.
constexpr std::int64_t kLatestStamp_ns = std::int64_t{1} << 62;
// A step of an id beyond this is no count of frames.
constexpr std::int64_t kLargestStep = 1'000'000;
// Stamp and id agree within half a period and this share of the way: the rate of a camera is known
// no better where it could not be measured yet.
constexpr double kRateTolerance = 0.002;
// The measured period is believed within this share of the nominal one.
constexpr double kPeriodTolerance = 0.02;
// Exposures over which the period is measured: jitter of the stamps counts little over many.
constexpr std::int64_t kShortestBaseline = 1024;
constexpr std::int64_t kLongBaseline = 16'384;
// So many replaced stamps in a row that follow each other are the camera's clock gone on from
// elsewhere.
constexpr int kStraysThatAnchor = 8;
// A restarted camera looks like frames that are late, but for long, in order, and with no other
// frame between.
constexpr int kLateThatRestart = 10;
constexpr std::int64_t kSilenceThatRestarts_ns = 100'000'000;
// By how much the way from exposure to arrival may be shorter than it ever was.
constexpr std::int64_t kEarlySlack_ns = 2'000'000;
// The first frame may have waited in the driver, so that the shortest way is known from the next
// one on.
constexpr int kWaysThatTell = 1;
// Clocks run apart by up to 100 ppm.
constexpr std::int64_t kClockDrift = 10'000;

bool agree(double exposures, std::int64_t step) {
  const auto steps = static_cast<double>(step);
  return std::abs(exposures - steps) <= 0.5 + kRateTolerance * steps;
}

}  // namespace

Intake::Intake(const LiveSourceInfo& info)
    : format_(info.format),
      ids_(info.id_bits, info.id_skips_zero),
      nominal_period_ns_(info.period_ns),
      period_ns_(static_cast<double>(info.period_ns)),
      clock_wraps_ns_(info.clock_wraps_ns) {}

void Intake::restart(const LiveSourceInfo& info) {
  ids_ = FrameIds(info.id_bits, info.id_skips_zero);
  nominal_period_ns_ = info.period_ns;
  period_ns_ = static_cast<double>(info.period_ns);
  clock_wraps_ns_ = info.clock_wraps_ns;
  restarting_ = has_newest_;
  forget_clock();
}

void Intake::forget_clock() {
  good_.reset();
  period_base_.reset();
  last_camera_ns_.reset();
  strays_ = 0;
}

Admission Intake::judge(Frame& frame, const FrameLabel& label) {
  const std::int64_t step = ids_.step(label.camera_id);
  const std::optional<std::int64_t> camera_ns = camera_time(label);
  Admission out;
  if (label.damaged)
    out.rejection = FrameRejection::damaged;
  else if (frame.view().format != format_)
    out.rejection = FrameRejection::wrong_format;

  Judged judged;
  if (!has_newest_) {
    judged = first(camera_ns, label);
  } else if (restarting_) {
    judged = by_arrival(camera_ns, label);
  } else if (step > 0 && step <= kLargestStep) {
    judged = by_step(step, camera_ns, label);
  } else if (step <= 0 && ids_.seen(step)) {
    if (out.rejection == FrameRejection::none) out.rejection = FrameRejection::duplicate;
    return out;
  } else if (const auto found =
                 camera_ns ? by_time_alone(*camera_ns, label) : std::optional<Judged>{};
             found) {
    judged = *found;
  } else if (step > 0) {  // neither id nor stamp makes sense
    judged = by_step(1, std::nullopt, label);
    judged.by_time = true;
  } else if (out.rejection == FrameRejection::none && was_restarted(step, label)) {
    forget_clock();
    judged = by_arrival(camera_ns, label);
  } else {
    if (out.rejection == FrameRejection::none) {
      out.rejection = FrameRejection::late;
      ids_.mark(step);
    }
    return out;
  }

  // The label of a frame that came in pieces may be anything.
  if (out.rejection != FrameRejection::none && !judged.agrees) return out;
  out.missing_before = has_newest_ ? judged.exposures - 1 : 0;
  place(judged, step, camera_ns, label);
  if (out.rejection != FrameRejection::none) return out;
  out.stamp_replaced = !judged.good;
  frame.index = newest_.index;
  frame.stamp.ns = newest_.stamp_ns;
  return out;
}

/// The camera's clock without its wraps; empty when the stamp is none.
std::optional<std::int64_t> Intake::camera_time(const FrameLabel& label) const {
  if (!label.camera_ns) return std::nullopt;
  std::int64_t camera_ns = *label.camera_ns;
  if (clock_wraps_ns_ > 0 && good_) {
    if (camera_ns < 0 || camera_ns >= clock_wraps_ns_) return std::nullopt;
    camera_ns += good_->camera_ns - good_->camera_ns % clock_wraps_ns_;
    // More than half a turn away is the other way round.
    if (good_->camera_ns - camera_ns > clock_wraps_ns_ / 2) camera_ns += clock_wraps_ns_;
    if (camera_ns - good_->camera_ns > clock_wraps_ns_ / 2) camera_ns -= clock_wraps_ns_;
  }
  if (camera_ns <= 0 || camera_ns >= kLatestStamp_ns) return std::nullopt;
  return camera_ns;
}

Intake::Judged Intake::first(const std::optional<std::int64_t>& camera_ns,
                             const FrameLabel& label) const {
  const bool has_stamp = camera_ns.has_value();
  return {.exposures = 0,
          .stamp_ns = has_stamp ? *camera_ns : label.arrival_ns,
          .good = has_stamp,
          .anchors = has_stamp};
}

/// Nothing that the camera says can be compared with what it said before.
Intake::Judged Intake::by_arrival(const std::optional<std::int64_t>& camera_ns,
                                  const FrameLabel& label) const {
  const std::int64_t since_ns = std::max(label.arrival_ns - newest_.arrival_ns, nominal_period_ns_);
  const std::int64_t exposures = std::llround(static_cast<double>(since_ns) / period_ns_);
  return {.exposures = std::max(std::int64_t{1}, exposures),
          .stamp_ns = newest_.stamp_ns + since_ns,
          .good = camera_ns.has_value(),
          .anchors = camera_ns.has_value(),
          .by_time = true};
}

/// Where the id says nothing (it jumped, or the counter began again) and the stamp goes on well.
std::optional<Intake::Judged> Intake::by_time_alone(std::int64_t camera_ns,
                                                    const FrameLabel& label) const {
  if (!good_ || camera_ns <= good_->camera_ns) return std::nullopt;
  const double since_good = static_cast<double>(camera_ns - good_->camera_ns) / period_ns_;
  const std::int64_t exposures = std::llround(since_good) - (newest_.index - good_->index);
  const std::int64_t stamp_ns = camera_ns + offset_ns_;
  const std::int64_t way_ns = label.arrival_ns - camera_ns;
  const bool plausible = exposures >= 1 && stamp_ns > newest_.stamp_ns &&
                         way_ns >= shortest_way_ns() &&
                         way_ns <= earliest_ns_ + kSilenceThatRestarts_ns;
  if (!plausible) return std::nullopt;
  return Judged{.exposures = exposures, .stamp_ns = stamp_ns, .good = true, .by_time = true};
}

Intake::Judged Intake::by_step(std::int64_t step, const std::optional<std::int64_t>& camera_ns,
                               const FrameLabel& label) const {
  const std::int64_t placed = good_ ? newest_.index - good_->index : 0;
  const std::int64_t expected_ns = good_ ? good_->camera_ns + offset_ns_ + periods_ns(placed + step)
                                         : newest_.stamp_ns + periods_ns(step);
  const Judged replaced{.exposures = step, .stamp_ns = std::max(expected_ns, newest_.stamp_ns + 1)};
  if (!camera_ns) return replaced;
  const auto anchored = [&] {
    Judged out = replaced;
    out.anchors = true;
    return out;
  };
  if (!good_) return anchored();

  if (*camera_ns > good_->camera_ns && *camera_ns + offset_ns_ > newest_.stamp_ns) {
    const double since_good = static_cast<double>(*camera_ns - good_->camera_ns) / period_ns_;
    Judged out{.exposures = step, .stamp_ns = *camera_ns + offset_ns_, .good = true};
    if (agree(since_good, placed + step)) {
      out.agrees = true;
      return out;
    }
    out.exposures = std::llround(since_good) - placed;
    if (time_is_right(step, out.exposures, *camera_ns, label)) return out;
  }
  return strays_ + 1 >= kStraysThatAnchor && clock_goes_on(step, *camera_ns) ? anchored()
                                                                             : replaced;
}

/// From the exposure to the arrival, as the two clocks have it.
std::int64_t Intake::shortest_way_ns() const {
  const std::int64_t slack_ns = ways_ < kWaysThatTell ? kSilenceThatRestarts_ns : kEarlySlack_ns;
  return earliest_ns_ - slack_ns - nominal_period_ns_ / 2;
}

/// Id and stamp disagree: which of them does the time of arrival support?
bool Intake::time_is_right(std::int64_t step, std::int64_t exposures, std::int64_t camera_ns,
                           const FrameLabel& label) const {
  if (exposures < 1) return false;
  if (exposures > step) {
    // A frame that waited in the driver arrives any time after its exposure, but not before.
    const std::int64_t way_ns = label.arrival_ns - camera_ns;
    return way_ns >= shortest_way_ns();
  }
  const std::int64_t between_ns = label.arrival_ns - newest_.arrival_ns;
  const std::int64_t by_stamp_ns = camera_ns + offset_ns_ - newest_.stamp_ns;
  return std::abs(between_ns - by_stamp_ns) < std::abs(between_ns - periods_ns(step));
}

/// Whether a stamp that contradicts the last good one follows the one just before it.
bool Intake::clock_goes_on(std::int64_t step, std::int64_t camera_ns) const {
  if (!last_camera_ns_ || camera_ns <= *last_camera_ns_) return false;
  return agree(static_cast<double>(camera_ns - *last_camera_ns_) / period_ns_, step);
}

/// A camera that began anew without being opened anew sends what looks late, and nothing else.
bool Intake::was_restarted(std::int64_t step, const FrameLabel& label) {
  const bool follows = late_run_ > 0 && step > last_late_step_;
  late_run_ = follows ? late_run_ + 1 : 1;
  last_late_step_ = step;
  return late_run_ > kLateThatRestart &&
         label.arrival_ns - newest_.arrival_ns > kSilenceThatRestarts_ns;
}

void Intake::place(const Judged& judged, std::int64_t step,
                   const std::optional<std::int64_t>& camera_ns, const FrameLabel& label) {
  const bool follows = has_newest_ && camera_ns && clock_goes_on(step, *camera_ns);
  newest_ = {.index = has_newest_ ? newest_.index + judged.exposures : 0,
             .stamp_ns = judged.stamp_ns,
             .arrival_ns = label.arrival_ns};
  has_newest_ = true;
  restarting_ = false;
  late_run_ = 0;
  if (judged.by_time) ids_.forget();
  ids_.accept(label.camera_id, judged.by_time ? 1 : step);

  if (judged.good || judged.anchors) {
    const std::int64_t way_ns = label.arrival_ns - *camera_ns;
    if (judged.anchors) {
      offset_ns_ = judged.stamp_ns - *camera_ns;
      earliest_ns_ = way_ns;
      ways_ = 0;
      period_base_.reset();
    } else {
      const std::int64_t drift_ns = (*camera_ns - good_->camera_ns) / kClockDrift;
      earliest_ns_ = std::min(earliest_ns_ + drift_ns, way_ns);
      ways_ = std::min(ways_ + 1, kWaysThatTell);
    }
    good_ = {.camera_ns = *camera_ns, .index = newest_.index};
    strays_ = 0;
    measure_period(*camera_ns);
  } else {
    strays_ = !camera_ns ? 0 : follows ? strays_ + 1 : 1;
  }
  if (camera_ns) last_camera_ns_ = camera_ns;
}

void Intake::measure_period(std::int64_t camera_ns) {
  const GoodStamp now{.camera_ns = camera_ns, .index = newest_.index};
  if (!period_base_) period_base_ = next_period_base_ = now;
  if (now.index - next_period_base_.index >= kLongBaseline) {
    period_base_ = next_period_base_;
    next_period_base_ = now;
  }
  const std::int64_t exposures = now.index - period_base_->index;
  if (exposures < kShortestBaseline) return;
  const double measured_ns =
      static_cast<double>(now.camera_ns - period_base_->camera_ns) / static_cast<double>(exposures);
  const auto nominal_ns = static_cast<double>(nominal_period_ns_);
  if (std::abs(measured_ns - nominal_ns) <= kPeriodTolerance * nominal_ns) period_ns_ = measured_ns;
}

std::int64_t Intake::periods_ns(std::int64_t exposures) const {
  return std::llround(static_cast<double>(exposures) * period_ns_);
}

}  // namespace lsv
