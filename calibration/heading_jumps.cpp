// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/heading_jumps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibration/ground_travel.h"
#include "calibration/robust.h"

namespace lsv {
namespace {

constexpr std::size_t kReach = 2;  // poses to either side
constexpr double kJump_sigmas = 8.0;
constexpr double kTurns = 3.0;
constexpr double kFastTurning = 0.8;  // quantile

/// How far the heading at `i` is from the median of those around it, rad: from the one that is
/// nearest to all, since angles have no order.
double deviation(const BodyReference& reference, std::size_t i) {
  double least_rad = std::numeric_limits<double>::infinity();
  double out = 0.0;
  for (std::size_t j = i - kReach; j <= i + kReach; ++j) {
    double sum_rad = 0.0;
    for (std::size_t l = i - kReach; l <= i + kReach; ++l)
      sum_rad += std::abs(turn_between(reference[j].yaw_rad, reference[l].yaw_rad));
    if (sum_rad >= least_rad) continue;
    least_rad = sum_rad;
    out = std::abs(turn_between(reference[j].yaw_rad, reference[i].yaw_rad));
  }
  return out;
}

}  // namespace

std::vector<bool> heading_jumps(const BodyReference& reference) {
  std::vector<bool> out(reference.size(), false);
  if (reference.size() <= 2 * kReach) return out;
  std::vector<double> turns_rad;
  for (std::size_t i = 1; i < reference.size(); ++i)
    turns_rad.push_back(std::abs(turn_between(reference[i - 1].yaw_rad, reference[i].yaw_rad)));
  // A smooth heading is never further from the median than the body turns between two poses.
  const double turning_rad = kTurns * quantile(std::move(turns_rad), kFastTurning);
  std::vector<double> deviations_rad;
  for (std::size_t i = kReach; i < reference.size() - kReach; ++i)
    deviations_rad.push_back(deviation(reference, i));
  const double usual_rad = kJump_sigmas * sigma_of_median(median(deviations_rad));
  for (std::size_t k = 0; k < deviations_rad.size(); ++k) {
    const std::size_t i = k + kReach;
    out[i] = deviations_rad[k] >
             std::max({usual_rad, turning_rad, kJump_sigmas * reference[i].sigma_yaw_rad});
  }
  return out;
}

}  // namespace lsv
