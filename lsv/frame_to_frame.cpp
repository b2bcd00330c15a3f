// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/frame_to_frame.h"

#include <utility>

#include "correlation/measure.h"
#include "lsv/gate.h"

namespace lsv {

Result<FrameToFrame> FrameToFrame::create(const TrackConfig& config, const FrameFormat& format,
                                          FixedPattern fixed_pattern) {
  Result<std::unique_ptr<Correlator>> correlator = make_correlator(config.correlation, format);
  if (!correlator) return correlator.error();
  return FrameToFrame(config, std::move(correlator).value(), std::move(fixed_pattern));
}

FrameToFrame::FrameToFrame(const TrackConfig& config, std::unique_ptr<Correlator> correlator,
                           FixedPattern fixed_pattern)
    : config_(config),
      fixed_pattern_(std::move(fixed_pattern)),
      correlator_(std::move(correlator)),
      plane_(correlator_->make_plane()),
      earlier_{.frame = correlator_->make_prepared_frame()},
      later_{.frame = correlator_->make_prepared_frame()} {}

PatternStep FrameToFrame::step(const FrameView& frame) {
  correlator_->prepare(fixed_pattern_.corrected(frame), later_.frame);
  later_.fitness = judge_frame(frame.format, later_.frame.stats, config_.gate, config_.calibration);
  later_.stamp = frame.stamp;
  later_.index = frame.index;

  PatternStep out;
  out.since = earlier_.stamp;
  out.keyframe = earlier_.index;
  if (earlier_.fitness != ShiftStatus::first_frame) out.shift = measure();
  if (out.shift.status == ShiftStatus::ok) {
    out.search = Search::full_range;
    path_.add(out.shift);
  }
  out.x_px = path_.x_px();
  out.y_px = path_.y_px();
  out.position_cov = path_.cov();
  // A repeated frame was exposed when its first copy was: that one stays the reference, so that
  // the next shift is divided by the time in which it came about.
  if (out.shift.status != ShiftStatus::frozen) std::swap(earlier_, later_);
  return out;
}

Shift FrameToFrame::measure() {
  for (const Slot* slot : {&earlier_, &later_}) {
    if (slot->fitness != ShiftStatus::ok) return with_status({}, slot->fitness);
  }
  if (refuses_repeats(config_.gate, config_.calibration) &&
      identical_pixels(earlier_.frame, later_.frame))
    return with_status({}, ShiftStatus::frozen);
  const ErrorModel model{.noise_sd_counts = config_.calibration.noise_sd_counts,
                         .engine = config_.correlation.engine};
  const Shift shift = measure_shift(*correlator_, config_.correlation.peak_fit, model,
                                    earlier_.frame, later_.frame, plane_);
  return with_status(shift, judge_search(shift, config_.gate));
}

}  // namespace lsv
