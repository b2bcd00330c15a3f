// SPDX-License-Identifier: BSD-3-Clause
// Where a sensor sits on a body: lever arm (x_m, y_m) and yaw in the body frame, from the track of
// the sensor and a reference trajectory of the body. The model, with frames and signs:
// docs/mount.md.
//
// In short: body at p with heading h, sensor at s = p + R(h) r, and the sensor travels
// ds = k R(h + yaw) dd when its track counts dd. Unknown are r, yaw, where asked k and the offset
// of the clocks, and besides them the true heading and place of the sensor at every reference pose,
// so that errors of the reference in position and heading and errors of the track all have their
// weight: total least squares by Gauss-Newton, a chain eliminated pose by pose. Where the track has
// a gap the chain breaks.
//
// Reference poses that lie more than 6 sigma off (or 6 times what is usual among the residuals,
// where that is more) are left out, up to a tenth of all; so are poses whose heading jumps out of
// those around it. Where the residuals are larger than the sigmas allow, the covariance is raised
// by chi2 / dof and `sigma_factor` says so. Pure functions; they allocate.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibration/drive.h"
#include "lsv/core/calibration.h"
#include "lsv/core/result.h"

namespace lsv {

struct MountOptions {
  /// Counts as one more measurement of the lever arm; with it the body need not turn.
  std::optional<KnownLever> lever{};
  /// Sigma of the scale of the calibration, relative: 0 takes it as exact, infinity as unknown.
  double scale_sigma_ratio = 0.0;
  /// Whether the clocks of track and reference may differ, by up to half a second.
  bool fit_clock = false;
};

/// Order of the rows: x_m, y_m, yaw_rad, scale_ratio, clock_offset_s.
using MountCovariance = std::array<std::array<double, 5>, 5>;

/// Reference less fit at one pose, in body axes.
struct MountResidual {
  Stamp stamp{};
  double forward_m = kUnknown;
  double left_m = kUnknown;
  double sigma_m = kUnknown;  // of the reference
};

struct MountFit {
  double x_m = kUnknown;
  double y_m = kUnknown;
  double yaw_rad = kUnknown;
  double scale_ratio = 1.0;     // true travel / travel of the track
  double clock_offset_s = 0.0;  // to be added to the times of the track
  MountCovariance cov{};        // zero for what was not fitted
  double chi2 = kUnknown;
  int dof = 0;
  double sigma_factor = 1.0;  // by which the sigmas were raised
  double travel_m = 0.0;      // way of the sensor that was used
  double turn_rad = 0.0;      // largest less smallest heading
  std::size_t poses = 0;      // used
  std::size_t outliers = 0;   // poses left out because they contradict the rest
  std::size_t gaps = 0;       // between poses: refused shifts, or no pose for too long
  std::vector<MountResidual> residuals;
};

/// bad_input, saying what the drive lacks, when track and reference do not overlap, when the drive
/// does not determine every figure, when more than a tenth of the poses would be left out, or when
/// the track fits only mirrored. Nothing is given in part.
Result<MountFit> fit_mount(const BodyReference& reference, const SensorTrack& track,
                           const MountOptions& options);

/// A body that never slips sideways cannot tell a sensor at x_m from one at -x_m with its y axis
/// turned round (docs/mount.md). The mount of that other sensor where it fits about as well as
/// `fit`; empty where the drive, or a known lever, excludes it.
std::optional<Mount> mirrored_mount(const BodyReference& reference, const SensorTrack& track,
                                    const MountOptions& options, const MountFit& fit);

Mount mount_of(const MountFit& fit);

}  // namespace lsv
