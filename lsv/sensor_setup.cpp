// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/sensor_setup.h"

#include <memory>
#include <new>
#include <utility>

#include "calibration/calibration_io.h"
#include "calibration/sensor_format.h"
#include "calibration/sensor_maps_io.h"

namespace lsv {

Result<void> set_calibration(TrackConfig& config, const std::string& path, const FrameFormat& whole,
                             const std::optional<Roi>& roi) {
  Result<Calibration> calibration = load_calibration(path);
  if (!calibration) return calibration.error();
  TrackConfig changed = config;
  changed.calibration = std::move(calibration).value();
  if (Result<void> set = set_sensor_maps(changed, path, whole, roi); !set) return set;
  config = std::move(changed);
  return {};
}

Result<void> set_sensor_maps(TrackConfig& config, const std::string& path, const FrameFormat& whole,
                             const std::optional<Roi>& roi) {
  if (Result<void> fits = check_format(config.calibration, path, whole); !fits) return fits;
  if (roi && !contains(whole, *roi)) {
    return Error{ErrorCode::invalid_argument,
                 "the region to be tracked does not lie inside the frames"};
  }
  Result<std::shared_ptr<const SensorMaps>> maps = load_sensor_maps(config.calibration, path);
  if (!maps) return maps.error();
  config.sensor_maps = std::move(maps).value();
  if (!config.sensor_maps || !roi) return {};
  try {
    config.sensor_maps = std::make_shared<const SensorMaps>(crop(*config.sensor_maps, *roi));
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::bad_input, path + ": there is not enough memory for its sensor maps"};
  }
  return {};
}

}  // namespace lsv
