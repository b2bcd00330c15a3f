// SPDX-License-Identifier: BSD-3-Clause
// The scale from runs of known travel: the 2 x 2 matrix M of travel_m = M shift_px by weighted
// least squares over all runs, with its covariance, and what each run says about it.
//
// A run is either end to end (one known vector) or a series of reference positions along the way;
// the place where a series begins is fitted with it. Each equation is weighted by the sigma of the
// reference and that of the track; where the residuals are larger than these allow, the covariance
// is raised by their ratio (chi2 / dof) and `sigma_factor` says so.
// Pure functions; they allocate.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lsv/core/calibration.h"
#include "lsv/core/result.h"
#include "lsv/core/shift.h"

namespace lsv {

/// The track and the reference at one time, both since the start of the run.
struct ScalePoint {
  double dx_px = 0.0;
  double dy_px = 0.0;
  ShiftCovariance cov{0.0, 0.0, 0.0};
  double x_m = 0.0;  // reference, along its own axes
  double y_m = 0.0;
  double sigma_m = 0.0;  // of the reference per axis, > 0
};

struct ScaleRun {
  std::string name;
  /// One point: end to end. More: a series.
  std::vector<ScalePoint> points;
};

/// Reference less fit at the end of the run.
struct ScaleResidual {
  std::string name;
  double x_m = kUnknown;
  double y_m = kUnknown;
  double sigma_x_m = kUnknown;  // of one such residual: reference and track
  double sigma_y_m = kUnknown;
  /// The same against a fit without this run, in sigmas of reference, track and that fit. NaN where
  /// the others alone do not determine the scale.
  double left_out_x_sigmas = kUnknown;
  double left_out_y_sigmas = kUnknown;
};

struct ScaleFit {
  double sc_x_ratio = kUnknown;
  double sc_y_ratio = kUnknown;
  ScaleOrientation orientation;
  ScaleCovariance cov{};
  double chi2 = kUnknown;
  int dof = 0;
  double sigma_factor = 1.0;  // by which the sigmas were raised
  std::vector<ScaleResidual> residuals;
};

/// bad_input when there are too few runs, or when they do not span both axes: what lies across the
/// only direction driven would be a guess. A run that travels across the main direction by a tenth
/// of the main travel is enough.
Result<ScaleFit> fit_scale(const std::vector<ScaleRun>& runs, double pixel_pitch_x_m,
                           double pixel_pitch_y_m);

/// `base` with the scale that was found; date, method and so on are for the caller to fill in.
Calibration with_scale(const Calibration& base, const ScaleFit& fit);

/// How far a second scale is from a first, figure by figure, in sigmas of the difference. NaN where
/// the first does not know its sigmas. Order: sc_x_ratio, sc_y_ratio, angle_rad, skew_rad.
struct ScaleChange {
  std::array<double, 4> difference{};  // second less first
  std::array<double, 4> sigmas{};
  bool mirror_changed = false;
};
ScaleChange compare_scales(const Calibration& first, const Calibration& second);

}  // namespace lsv
