// SPDX-License-Identifier: BSD-3-Clause
// The fixed pattern of a sensor, pixel by pixel, as a calibration knows it. Row-major.
#pragma once

#include <cstdint>
#include <vector>

#include "lsv/core/frame.h"

namespace lsv {

struct SensorMaps {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> offset_counts{};  // mean dark level of each pixel
  std::vector<float> gain_ratio{};     // response of each pixel over that of all, > 0
  std::vector<std::uint8_t> defect{};  // 1: the pixel tells nothing
};

/// What frames cut to `roi` need of them; `roi` must lie inside.
SensorMaps crop(const SensorMaps& maps, const Roi& roi);

}  // namespace lsv
