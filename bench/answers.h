// SPDX-License-Identifier: BSD-3-Clause
// Is an answer right? Every method is held against the true shift of the simulated pair, with a
// tolerance several times the errors measured on these frames and far below what a wrong peak, a
// wrong sign or swapped axes would give.
#pragma once

#include <string>

#include "correlation/correlator.h"
#include "lsv/core/config.h"
#include "tools/simulated_loop.h"

namespace lsv::bench {

struct Answer {
  double dx_px = 0.0;
  double dy_px = 0.0;
};

/// Empty when both axes are within `tolerance_px` of the truth; else a sentence. NaN is wrong.
std::string wrong(const Answer& answer, const cli::TrueShift& truth, double tolerance_px);

/// For zncc, cross and direct.
double tolerance_px(Engine engine, PeakFit fit);

/// Whether the peak of `plane` stands at the truth: to sub-pixel tolerance, except for phase, whose
/// whitened planes are too ragged for that on small frames: its highest lag, to one pixel.
std::string wrong(const CorrelationPlane& plane, Engine engine, PeakFit fit,
                  const cli::TrueShift& truth);

}  // namespace lsv::bench
