// SPDX-License-Identifier: BSD-3-Clause
// From two frames to one shift with quality and covariance: correlate, find the peak, measure.
// The status is the peak's own (ok, peak_at_border, flat_peak); frames and gates are judged by
// lsv/gate.
#pragma once

#include "correlation/correlator.h"
#include "correlation/peak.h"
#include "correlation/quality.h"

namespace lsv {

/// Does not allocate. `plane` is left holding the correlation plane of this pair.
Shift measure_shift(Correlator& correlator, PeakFit fit, const ErrorModel& model,
                    const PreparedFrame& earlier, const PreparedFrame& later,
                    CorrelationPlane& plane);

}  // namespace lsv
