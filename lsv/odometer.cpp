// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/odometer.h"

#include <new>
#include <string>
#include <utility>

#include "correlation/measure.h"
#include "lsv/gate.h"

namespace lsv {

Result<Odometer> Odometer::create(const TrackConfig& config, const FrameFormat& format) {
  if (const Result<void> valid = validate(config); !valid) return valid.error();
  if (!is_possible(format)) {
    return Error{ErrorCode::invalid_argument, "frames of " + std::to_string(format.width_px) +
                                                  " x " + std::to_string(format.height_px) +
                                                  " px with " + std::to_string(format.bit_depth) +
                                                  " bit cannot be tracked"};
  }
  try {
    Result<std::unique_ptr<Correlator>> correlator = make_correlator(config.correlation, format);
    if (!correlator) return correlator.error();
    return Odometer(config, std::move(correlator).value());
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::invalid_argument,
                 "there is not enough memory for frames of " + std::to_string(format.width_px) +
                     " x " + std::to_string(format.height_px) +
                     " px with this search range: use --roi or a smaller --max-shift"};
  }
}

Odometer::Odometer(const TrackConfig& config, std::unique_ptr<Correlator> correlator)
    : config_(config),
      scale_(pixel_scale(config.calibration)),
      correlator_(std::move(correlator)),
      plane_(correlator_->make_plane()),
      earlier_{.frame = correlator_->make_prepared_frame()},
      later_{.frame = correlator_->make_prepared_frame()} {}

Result<StepReport> Odometer::push(const FrameView& frame) {
  if (const Result<void> usable = check(frame); !usable) return usable.error();
  correlator_->prepare(frame, later_.frame);
  later_.fitness = judge_frame(frame.format, later_.frame.stats, config_.gate, config_.calibration);
  later_.stamp = frame.stamp;

  StepReport report{.frame = frame.index, .stamp = frame.stamp};
  if (earlier_.fitness != ShiftStatus::first_frame) {
    report.dt_ns = later_.stamp.ns - earlier_.stamp.ns;
    report.shift = measure();
  }
  if (report.shift.status == ShiftStatus::ok) {
    const Displacement travel = displacement(report.shift, scale_);
    report.velocity = velocity(travel, seconds_between(earlier_.stamp, later_.stamp));
    integrator_.add(travel);
  }
  report.position = integrator_.position();
  last_stamp_ = frame.stamp;
  // A repeated frame was exposed when its first copy was: that one stays the reference, so that
  // the next shift is divided by the time in which it came about.
  if (report.shift.status != ShiftStatus::frozen) std::swap(earlier_, later_);
  return report;
}

Shift Odometer::measure() {
  for (const Slot* slot : {&earlier_, &later_}) {
    if (slot->fitness != ShiftStatus::ok) return with_status({}, slot->fitness);
  }
  if (is_frozen(earlier_.frame, later_.frame, config_.gate, config_.calibration))
    return with_status({}, ShiftStatus::frozen);
  const ErrorModel model{.noise_sd_counts = config_.calibration.noise_sd_counts,
                         .engine = config_.correlation.engine};
  const Shift shift = measure_shift(*correlator_, config_.correlation.peak_fit, model,
                                    earlier_.frame, later_.frame, plane_);
  return with_status(shift, judge_shift(shift, config_.gate));
}

Result<void> Odometer::check(const FrameView& frame) const {
  if (frame.format != correlator_->format()) {
    return Error{ErrorCode::bad_input, "frame " + std::to_string(frame.index) + " is " +
                                           std::to_string(frame.width_px()) + " x " +
                                           std::to_string(frame.height_px()) + " px, " +
                                           std::to_string(frame.format.bit_depth) +
                                           " bit, unlike the frames before it"};
  }
  if (earlier_.fitness == ShiftStatus::first_frame) return {};
  std::int64_t dt_ns = 0;
  const bool overflows = __builtin_sub_overflow(frame.stamp.ns, earlier_.stamp.ns, &dt_ns);
  if (frame.stamp <= last_stamp_ || overflows) {
    return Error{ErrorCode::bad_input, "the time stamp of frame " + std::to_string(frame.index) +
                                           (overflows ? " is out of range" : " does not increase")};
  }
  return {};
}

}  // namespace lsv
