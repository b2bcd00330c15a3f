// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/slip_cusum.h"

#include <algorithm>
#include <cmath>

namespace lsv::fusion {

void SlipCusum::add(const SlipConfig& config, double faster_m_s, double slower_m_s,
                    double sigma_m_s) {
  const double forward = faster_m_s < 0.0 ? -1.0 : 1.0;
  const double lost_m_s = forward * (faster_m_s - slower_m_s);
  // At least so much: the size of what is only noise is 0.8 sigma on average.
  constexpr double kLeastSigmas = 2.0;
  const double told_m_s =
      std::max(config.alarm_ratio * std::abs(faster_m_s), kLeastSigmas * sigma_m_s);
  const double step = (lost_m_s - told_m_s) / sigma_m_s;
  slips_ = std::clamp(slips_ + step, 0.0, config.threshold_sigmas);
  grips_ = std::clamp(grips_ - step, 0.0, config.threshold_sigmas);
  if (slips_ >= config.threshold_sigmas) {
    alarm_ = true;
  } else if (grips_ >= config.threshold_sigmas) {
    alarm_ = false;
  }
}

}  // namespace lsv::fusion
