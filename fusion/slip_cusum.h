// SPDX-License-Identifier: BSD-3-Clause
// When a wheel slips: a cumulative sum (Page 1954) on the difference of rim speed and ground speed,
// with another sum that takes the alarm back. It is fed speeds, not ratios, so that a wheel that
// hardly turns tells nothing, whatever its encoder rounds to. Internal to fusion/. A plain value.
#pragma once

#include "fusion/rover_config.h"

namespace lsv::fusion {

class SlipCusum {
 public:
  /// Speeds of the wheel, positive forward: how much the one lacks of the other. For a wheel that
  /// spins these are ground and rim, for one that is dragged rim and ground. `sigma_m_s` is that of
  /// their difference.
  void add(const SlipConfig& config, double faster_m_s, double slower_m_s, double sigma_m_s);
  bool alarm() const { return alarm_; }

 private:
  double slips_ = 0.0;  // sigmas
  double grips_ = 0.0;
  bool alarm_ = false;
};

}  // namespace lsv::fusion
