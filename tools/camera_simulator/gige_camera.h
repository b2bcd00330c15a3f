// SPDX-License-Identifier: BSD-3-Clause
// A GigE Vision camera on a network interface of this machine that sends simulated exposures over
// the real protocol: the fake camera of Aravis with our frames in it.
//
// Exposures lie on a grid of the camera's clock, one per period; a slot of the grid that is missed
// because the machine is busy is an exposure that never was, and the pattern moves on meanwhile.
// Every frame sent is noted. Own thread inside; the functions are for one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lsv/core/result.h"
#include "tools/camera_simulator/exposures.h"

namespace lsv::cli {

/// A frame that was sent, with the truth about it.
struct SentFrame {
  std::int64_t camera_id = 0;  // as on the wire: 16 bits
  std::int64_t stamp_ns = 0;   // on the camera's clock, which is the wall clock of this machine
  std::int64_t exposure = 0;   // its number, which counts missed ones
  double x_px = 0.0;           // of the pattern
  double y_px = 0.0;
  std::uint64_t checksum = 0;  // pixel_checksum.h
};

struct GigeCameraConfig {
  std::string address = "127.0.0.1";  // of an interface of this machine
  std::string serial = "LSV01";
  double rate_hz = 250.0;          // until the client sets another one
  double packet_loss_ratio = 0.0;  // of all stream packets, [0, 1]
};

class GigeCamera {
 public:
  /// `exposures` must outlive the camera. Not yet plugged in.
  GigeCamera(const GigeCameraConfig& config, const Exposures& exposures);
  GigeCamera(const GigeCamera&) = delete;
  GigeCamera& operator=(const GigeCamera&) = delete;
  ~GigeCamera();

  /// Answers from now on, as a camera that has just been switched on. Exposure numbers go on.
  Result<void> plug_in();
  /// From one packet to the next nothing answers any more.
  void unplug();

  /// What was sent since the call before, in order.
  std::vector<SentFrame> take_sent();

 private:
  struct Body;
  std::unique_ptr<Body> body_;
};

}  // namespace lsv::cli
