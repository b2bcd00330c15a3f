// SPDX-License-Identifier: BSD-3-Clause
// The file of the sensor maps: a TIFF of three pages, offset in counts, gain as a ratio > 0, defect
// 0 or 1. All are 32-bit float, uncompressed, of one size: ImageJ shows only pages of one type as a
// stack. What is read back is strict: three such pages and finite numbers within bounds. Errors are
// one sentence that names the file. Memory: about twice the file, which has 12 bytes a pixel.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "lsv/core/calibration.h"
#include "lsv/core/result.h"
#include "lsv/core/sensor_maps.h"

namespace lsv {

/// The bytes of the file; the same maps give the same bytes. invalid_argument when the maps are
/// inconsistent or memory is short.
Result<std::string> sensor_maps_tiff(const SensorMaps& maps);

/// `name` stands for the file in error messages. Reads back what sensor_maps_tiff() wrote.
Result<SensorMaps> parse_sensor_maps(std::string_view bytes, const std::string& name);

/// The maps that `calibration`, read from `calibration_path`, names: the file lies relative to the
/// folder of the calibration, has the SHA-256 of [maps] and the size of [format]. Null when the
/// calibration has no [maps].
Result<std::shared_ptr<const SensorMaps>> load_sensor_maps(const Calibration& calibration,
                                                           const std::string& calibration_path);

/// Where the maps of that calibration lie. Empty when it has none.
std::string sensor_maps_path(const Calibration& calibration, const std::string& calibration_path);

/// `calibration`, read from `calibration_path`, as it must be written to a file in `folder`: its
/// maps stay where they are.
Calibration with_maps_seen_from(const std::string& folder, Calibration calibration,
                                const std::string& calibration_path);

}  // namespace lsv
