// SPDX-License-Identifier: BSD-3-Clause
// The velocity of one LSV sensor in the axes of its vehicle, as plots show it.
#pragma once

#include <cmath>

namespace lsv::cli {

/// Along body x, of the place of the sensor. `yaw_rad` is from body x to sensor x,
/// counter-clockwise; the velocity is in sensor axes with z up.
inline double forward_m_s(double vx_m_s, double vy_m_s, double yaw_rad) {
  return std::cos(yaw_rad) * vx_m_s - std::sin(yaw_rad) * vy_m_s;
}

}  // namespace lsv::cli
