// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/sensor_maps.h"

#include <cstddef>

namespace lsv {
namespace {

template <typename Value>
std::vector<Value> crop(const std::vector<Value>& map, int width_px, const Roi& roi) {
  std::vector<Value> out;
  out.reserve(static_cast<std::size_t>(roi.width_px) * static_cast<std::size_t>(roi.height_px));
  for (int y = roi.y_px; y < roi.y_px + roi.height_px; ++y) {
    const auto row = map.begin() + static_cast<std::ptrdiff_t>(y) * width_px + roi.x_px;
    out.insert(out.end(), row, row + roi.width_px);
  }
  return out;
}

}  // namespace

SensorMaps crop(const SensorMaps& maps, const Roi& roi) {
  return {.width_px = roi.width_px,
          .height_px = roi.height_px,
          .offset_counts = crop(maps.offset_counts, maps.width_px, roi),
          .gain_ratio = crop(maps.gain_ratio, maps.width_px, roi),
          .defect = crop(maps.defect, maps.width_px, roi)};
}

}  // namespace lsv
