// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/shift_meter.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <string>
#include <utility>

#include "correlation/quality.h"
#include "lsv/gate.h"

namespace lsv {
namespace {

Refinement refinement_of(Preset preset) {
  return preset == Preset::precise ? Refinement::icgn : Refinement::none;
}

/// Two estimates of the same maximum differ by less.
constexpr double kSameMaximum_px = 1.5;

}  // namespace

Result<ShiftMeter> ShiftMeter::create(const TrackConfig& config, const FrameFormat& format) {
  if (const Result<void> valid = validate(config); !valid) return valid.error();
  const std::string size =
      std::to_string(format.width_px) + " x " + std::to_string(format.height_px) + " px";
  if (!is_possible(format)) {
    return Error{ErrorCode::invalid_argument, "frames of " + size + " with " +
                                                  std::to_string(format.bit_depth) +
                                                  " bit cannot be tracked"};
  }
  try {
    Result<Acquisition> acquisition = Acquisition::create(config, format);
    if (!acquisition) return acquisition.error();
    return ShiftMeter(config, format, std::move(acquisition).value());
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::invalid_argument,
                 "there is not enough memory for frames of " + size +
                     " with this search range: use --roi or a smaller --max-shift"};
  }
}

ShiftMeter::ShiftMeter(const TrackConfig& config, const FrameFormat& format,
                       Acquisition acquisition)
    : preset_(config.preset),
      gate_(config.gate),
      camera_(config.calibration),
      format_(format),
      acquisition_(std::move(acquisition)),
      tracker_(format, refinement_of(config.preset), config.calibration.noise_sd_counts) {}

TrackReference ShiftMeter::make_reference() const {
  return preset_ == Preset::precise ? TrackReference(format_) : TrackReference();
}

double ShiftMeter::speckle_px(const TrackReference& reference) const {
  constexpr double kUsually_px = 8.0;
  if (preset_ != Preset::precise) return kUsually_px;
  // Kernels come in steps, each for speckle up to the next; the last is for whatever is larger.
  constexpr double kStep = 1.2;
  constexpr double kLargest_px = 9.0;
  const double size_px = std::max(reference.kernel_x().fwhm_px(), reference.kernel_y().fwhm_px());
  return size_px > kLargest_px ? 2.0 * size_px : kStep * size_px;
}

ShiftStatus ShiftMeter::fitness(const TrackFrame& frame) const {
  return judge_frame(format_, frame.stats(), gate_, camera_);
}

bool ShiftMeter::frozen(const TrackFrame& earlier, const TrackFrame& later) const {
  return refuses_repeats(gate_, camera_) && later.same_pixels(earlier);
}

Shift ShiftMeter::acquire(const TrackFrame& earlier, const TrackFrame& later) {
  return acquisition_.measure(earlier, later);
}

TrackedShift ShiftMeter::refine(const TrackFrame& earlier, const TrackReference& reference,
                                const TrackFrame& later, const Shift& acquired) {
  if (acquired.status == ShiftStatus::ok) last_search_ = acquired.quality;
  TrackedShift found{.shift = acquired, .noise_cov = acquired.cov, .boiling_cov = {0.0, 0.0, 0.0}};
  if (acquired.status != ShiftStatus::ok || preset_ == Preset::classic) return found;
  const auto as_acquired = [&] {
    found.rows = tracker_.rows_at(earlier, later, acquired.dx_px, acquired.dy_px);
    judge(found);
    return found;
  };
  if (preset_ != Preset::precise) return as_acquired();
  const TrackedShift tracked =
      tracker_.measure(earlier, reference, later, acquired.dx_px, acquired.dy_px);
  // Where too little overlaps for IC-GN the peak fit of the search is the better one; elsewhere
  // the two must agree.
  if (tracked.shift.status != ShiftStatus::ok || !tracked.refined ||
      std::abs(tracked.shift.dx_px - acquired.dx_px) > kSameMaximum_px ||
      std::abs(tracked.shift.dy_px - acquired.dy_px) > kSameMaximum_px)
    return as_acquired();
  found = tracked;
  take_background(found.shift.quality);
  judge(found);
  return found;
}

TrackedShift ShiftMeter::follow(const TrackFrame& earlier, const TrackReference& reference,
                                const TrackFrame& later, double guess_dx_px, double guess_dy_px) {
  TrackedShift out = tracker_.measure(earlier, reference, later, guess_dx_px, guess_dy_px);
  take_background(out.shift.quality);
  judge(out);
  return out;
}

void ShiftMeter::judge(TrackedShift& tracked) const {
  ShiftStatus status = judge_shift(tracked.shift, gate_);
  if (status == ShiftStatus::ok && checks_rows_ && gate_.refuse_inconsistent)
    status = judge_rows(tracked.rows, tracked.shift.cov);
  tracked.shift = with_status(tracked.shift, status);
}

bool ShiftMeter::rows_agree(const TrackedShift& tracked) {
  return judge_rows(tracked.rows, tracked.shift.cov) == ShiftStatus::ok;
}

void ShiftMeter::take_background(ShiftQuality& quality) const {
  quality.outlier_probability = outlier_probability(quality.zncc_sigmas);
  const double ratio = quality.zncc / last_search_.zncc;
  quality.q = last_search_.q * ratio;
  quality.peak_ratio = last_search_.peak_ratio * ratio;
  quality.peak_to_rms = last_search_.peak_to_rms * ratio;
}

}  // namespace lsv
