// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/acquisition.h"

#include <utility>

#include "correlation/measure.h"
#include "lsv/gate.h"

namespace lsv {

Result<Acquisition> Acquisition::create(const TrackConfig& config, const FrameFormat& format) {
  Result<std::unique_ptr<Correlator>> correlator = make_correlator(config.correlation, format);
  if (!correlator) return correlator.error();
  return Acquisition(config, std::move(correlator).value());
}

Acquisition::Acquisition(const TrackConfig& config, std::unique_ptr<Correlator> correlator)
    : fit_(config.correlation.peak_fit),
      model_{.noise_sd_counts = config.calibration.noise_sd_counts,
             .engine = config.correlation.engine},
      gate_(config.gate),
      correlator_(std::move(correlator)),
      plane_(correlator_->make_plane()),
      earlier_(correlator_->make_prepared_frame()),
      later_(correlator_->make_prepared_frame()) {}

Shift Acquisition::measure(const TrackFrame& earlier, const TrackFrame& later) {
  correlator_->prepare(earlier.view(), earlier_);
  correlator_->prepare(later.view(), later_);
  const Shift shift = measure_shift(*correlator_, fit_, model_, earlier_, later_, plane_);
  return with_status(shift, judge_search(shift, gate_));
}

}  // namespace lsv
