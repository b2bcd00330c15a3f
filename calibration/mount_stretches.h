// SPDX-License-Identifier: BSD-3-Clause
// Whether all of a drive tells of the same mount: the drive in stretches of equal time, each
// against the fit to the others. Pure functions; they allocate.
#pragma once

#include <vector>

#include "calibration/mount_fit.h"

namespace lsv {

/// NaN where the others alone do not determine the mount.
struct MountStretch {
  Stamp begin{};
  Stamp end{};
  /// By how much chi2 falls beyond what its degrees of freedom take with them when the stretch is
  /// left out, in standard deviations; residuals that are too large everywhere do not count.
  double misfit_sigmas = kUnknown;
  double change_x_m = kUnknown;  // without the stretch less with it
  double change_y_m = kUnknown;
  double change_yaw_rad = kUnknown;
};

/// `fit` is what fit_mount() said of the same arguments.
std::vector<MountStretch> leave_out_stretches(const BodyReference& reference,
                                              const SensorTrack& track, const MountOptions& options,
                                              const MountFit& fit);

}  // namespace lsv
