// SPDX-License-Identifier: BSD-3-Clause
// The Q gate: may this shift be used? First the two frames are judged (dark, saturated, low
// contrast, frozen), then the correlation (border, shape, ZNCC, ambiguity, Q). The first reason
// found is the one reported. Pure functions of the measurements and the settings.
#pragma once

#include "correlation/prepared_frame.h"
#include "correlation/row_probe.h"
#include "lsv/core/config.h"
#include "lsv/core/shift.h"

namespace lsv {

/// ok, dark, saturated or low_contrast.
ShiftStatus judge_frame(const FrameFormat& format, const FrameStats& stats, const GateConfig& gate,
                        const Calibration& camera);

/// Whether a repeated frame is `frozen`: a camera that has noise never delivers the same one twice.
bool refuses_repeats(const GateConfig& gate, const Calibration& camera);

/// The status that `shift` deserves; its own status if that is already a refusal.
ShiftStatus judge_shift(const Shift& shift, const GateConfig& gate);

/// The same for a shift found by a full search, which also tells whether something that stays on
/// the sensor outweighs the ground.
ShiftStatus judge_search(const Shift& shift, const GateConfig& gate);

/// ok, or inconsistent: whole rows differ from the rest by more than chance and by enough to matter
/// for a shift with this covariance.
ShiftStatus judge_rows(const RowAgreement& rows, const ShiftCovariance& cov);

/// `shift` with `status`; the numbers become NaN and the quality stays unless it is ok.
Shift with_status(const Shift& shift, ShiftStatus status);

}  // namespace lsv
