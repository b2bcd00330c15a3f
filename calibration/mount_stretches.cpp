// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/mount_stretches.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace lsv {
namespace {

constexpr int kStretches = 8;

void judge(const BodyReference& reference, const SensorTrack& track, const MountOptions& options,
           const MountFit& fit, MountStretch& stretch) {
  BodyReference rest;
  for (const ReferencePose& pose : reference) {
    if (pose.stamp < stretch.begin || pose.stamp > stretch.end) rest.push_back(pose);
  }
  const Result<MountFit> fitted = fit_mount(rest, track, options);
  if (!fitted) return;
  const MountFit& without = fitted.value();
  stretch.change_x_m = without.x_m - fit.x_m;
  stretch.change_y_m = without.y_m - fit.y_m;
  stretch.change_yaw_rad = std::remainder(without.yaw_rad - fit.yaw_rad, 2.0 * std::numbers::pi);
  const double usual = std::max(1.0, without.chi2 / without.dof);
  const double dof = fit.dof - without.dof;
  if (dof > 0.0)
    stretch.misfit_sigmas = ((fit.chi2 - without.chi2) / usual - dof) / std::sqrt(2.0 * dof);
}

}  // namespace

std::vector<MountStretch> leave_out_stretches(const BodyReference& reference,
                                              const SensorTrack& track, const MountOptions& options,
                                              const MountFit& fit) {
  std::vector<MountStretch> out;
  const std::int64_t first_ns = fit.residuals.front().stamp.ns;
  const std::int64_t whole_ns = fit.residuals.back().stamp.ns - first_ns;
  for (int i = 0; i < kStretches; ++i) {
    MountStretch stretch{.begin = {first_ns + whole_ns / kStretches * i},
                         .end = {first_ns + whole_ns / kStretches * (i + 1)}};
    judge(reference, track, options, fit, stretch);
    out.push_back(stretch);
  }
  return out;
}

}  // namespace lsv
