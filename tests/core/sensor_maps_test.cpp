// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/sensor_maps.h"

#include <gtest/gtest.h>

namespace lsv {
namespace {

TEST(SensorMaps, ACropIsWhatTheRegionShows) {
  SensorMaps maps{.width_px = 5, .height_px = 4};
  for (int i = 0; i < 20; ++i) {
    maps.offset_counts.push_back(static_cast<float>(i));
    maps.gain_ratio.push_back(1.0F + static_cast<float>(i));
    maps.defect.push_back(i == 8 ? 1 : 0);
  }
  const SensorMaps part = crop(maps, {.x_px = 2, .y_px = 1, .width_px = 3, .height_px = 2});
  EXPECT_EQ(part.width_px, 3);
  EXPECT_EQ(part.height_px, 2);
  EXPECT_EQ(part.offset_counts, (std::vector<float>{7, 8, 9, 12, 13, 14}));
  EXPECT_EQ(part.gain_ratio, (std::vector<float>{8, 9, 10, 13, 14, 15}));
  EXPECT_EQ(part.defect, (std::vector<std::uint8_t>{0, 1, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace lsv
