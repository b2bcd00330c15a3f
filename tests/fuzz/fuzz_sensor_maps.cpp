// SPDX-License-Identifier: BSD-3-Clause
// Sensor maps are accepted whole, finite and in range, and then read back as written; or refused by
// name, whatever memory they were read into.
#include <cmath>
#include <string>

#include "calibration/sensor_maps_io.h"
#include "tests/fuzz/frame_checks.h"
#include "tests/fuzz/heap_fill.h"

namespace {

using lsv::fuzz::require;

/// Into a heap whose every byte is `value`, so that a pixel nobody wrote shows it.
lsv::Result<lsv::SensorMaps> parse_over(int value, const std::string& bytes) {
  const lsv::fuzz::HeapFill heap(value);
  return lsv::parse_sensor_maps(bytes, "fuzz.tif");
}

bool same(const lsv::SensorMaps& a, const lsv::SensorMaps& b) {
  return a.width_px == b.width_px && a.height_px == b.height_px &&
         a.offset_counts == b.offset_counts && a.gain_ratio == b.gain_ratio && a.defect == b.defect;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const auto first = parse_over(0x00, bytes);
  const auto second = parse_over(0xFF, bytes);
  require(first.ok() == second.ok(), "acceptance depends on the file alone");
  if (!first) {
    require(first.error().message.find("fuzz.tif") == 0, "an error names the file");
    require(first.error().message == second.error().message, "an error depends on the file alone");
    return 0;
  }
  const lsv::SensorMaps& maps = first.value();
  require(same(maps, second.value()), "pixels depend on the file alone");
  const std::size_t pixels =
      static_cast<std::size_t>(maps.width_px) * static_cast<std::size_t>(maps.height_px);
  require(pixels > 0 && maps.offset_counts.size() == pixels && maps.gain_ratio.size() == pixels &&
              maps.defect.size() == pixels,
          "every pixel has its values");
  for (std::size_t i = 0; i < pixels; ++i) {
    require(std::isfinite(maps.offset_counts[i]), "an offset is a number");
    require(maps.gain_ratio[i] > 0.0F && std::isfinite(1.0F / maps.gain_ratio[i]),
            "a gain can be divided by");
    require(maps.defect[i] <= 1, "a pixel is defect or not");
  }
  const auto written = lsv::sensor_maps_tiff(maps);
  require(written.ok(), "what was read can be written");
  const auto again = lsv::parse_sensor_maps(written.value(), "again.tif");
  require(again.ok() && same(again.value(), maps), "what was written reads back");
  return 0;
}
