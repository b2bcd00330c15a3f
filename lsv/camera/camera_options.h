// SPDX-License-Identifier: BSD-3-Clause
// How a camera is to be set before it streams. What is not given stays as the camera has it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "lsv/core/frame.h"
#include "lsv/core/stamp.h"

namespace lsv {

struct CameraOptions {
  std::optional<Roi> region{};  // of the sensor
  std::string pixel_format{};   // GenICam name: Mono8, Mono10, Mono12, Mono14 or Mono16
  std::optional<double> rate_hz{};
  std::optional<double> exposure_s{};

  /// Frames that the driver may hold until they are grabbed, [2, 4096]: 64 ms of slack at 1 kHz.
  int buffers = 64;

  // GigE Vision only
  std::optional<int> packet_size_bytes{};  // [220, 16000]; what the network carries unfragmented
  /// After this long without a packet the missing ones are asked for again; at least 1 ms.
  std::int64_t packet_timeout_ns = 1'000'000;
  /// After this long without a packet an incomplete frame is given up; one frame that waits holds
  /// back the ones behind it. Unset: four periods, at least 4 ms.
  std::optional<std::int64_t> frame_retention_ns{};

  /// A camera that sends nothing for this long is gone: grab() returns an error and the source has
  /// to be opened anew. At least five periods are waited for.
  std::int64_t gone_after_ns = kNsPerS / 2;
};

}  // namespace lsv
