// SPDX-License-Identifier: BSD-3-Clause
#include "tools/live_settings.h"

#include <algorithm>
#include <cmath>

namespace lsv::cli {
namespace {

/// What is no number of ns is out of every range that a setting has.
std::int64_t ns_of(double value, double ns_per_unit) {
  const double ns = value * ns_per_unit;
  return std::isfinite(ns) ? std::llround(std::clamp(ns, -1e18, 1e18)) : -1;
}

}  // namespace

void add_live_settings(CLI::App& command, Settings& settings, LiveSettings& live) {
  settings.add(command, "rate_hz", "--rate-hz", "Frames per second to set [as the camera is set]",
               "", number(live.camera.rate_hz));
  settings.add(command, "exposure_us", "--exposure-us", "Exposure to set [as the camera is set]",
               "", number(live.exposure_us));
  settings.add(command, "roi", "--roi", "Region of the sensor to set, px: x,y,w,h", "",
               parsed_by(live.camera.region, "X,Y,W,H", parse_roi));
  settings.add(command, "pixel_format", "--pixel-format",
               "Mono8, Mono10, Mono12, Mono14 or Mono16 [as the camera is set]", "",
               text(live.camera.pixel_format));
  settings.add(command, "buffers", "--buffers", "Frames that the driver may hold [64]", "",
               whole(live.buffers));
  settings.add(command, "packet_size_bytes", "--packet-size",
               "Of a GigE camera, bytes; what the network carries unfragmented", "",
               whole(live.camera.packet_size_bytes));
  settings.add(command, "frame_retention_ms", "--frame-retention-ms",
               "A GigE frame without its rest is given up after so long [4 periods]", "",
               number(live.frame_retention_ms));
  settings.add(command, "lost_after_ms", "--lost-after-ms",
               "Silence after which the camera counts as lost [90]", "",
               number(live.lost_after_ms));
  settings.add(command, "reopen_attempts", "--reopen-attempts",
               "A camera that is gone is given up after so many attempts in a row [10]", "",
               whole(live.reopen_attempts));
  settings.add(command, "queue_frames", "--queue-frames",
               "Frames that may wait to be measured; then the oldest is dropped [64]", "",
               whole(live.queue_frames));
  settings.add(command, "fifo_priority", "--fifo-priority",
               "Real-time priority of the threads (SCHED_FIFO), 1 to 98", "",
               whole(live.fifo_priority));
  settings.add_switch(command, "lock_memory", "--lock-memory,!--no-lock-memory",
                      "Keep the program in memory [false]", live.stream.lock_memory);
  add_measuring_settings(command, settings, live.track);
}

Result<void> resolve_live(LiveSettings& live) {
  constexpr double kNsPerMs = 1e6;
  if (live.exposure_us) live.camera.exposure_s = *live.exposure_us * 1e-6;
  if (live.frame_retention_ms)
    live.camera.frame_retention_ns = ns_of(*live.frame_retention_ms, kNsPerMs);
  if (live.lost_after_ms) live.stream.lost_after_ns = ns_of(*live.lost_after_ms, kNsPerMs);
  live.camera.buffers = live.buffers.value_or(live.camera.buffers);
  live.stream.queue_frames = live.queue_frames.value_or(live.stream.queue_frames);
  live.stream.fifo_priority = live.fifo_priority.value_or(live.stream.fifo_priority);
  live.reopening.attempts = live.reopen_attempts.value_or(live.reopening.attempts);
  if (live.reopening.attempts < 1)
    return Error{ErrorCode::invalid_argument, "--reopen-attempts must be at least 1"};
  return {};
}

}  // namespace lsv::cli
