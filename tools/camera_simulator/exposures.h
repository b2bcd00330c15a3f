// SPDX-License-Identifier: BSD-3-Clause
// The exposures of a simulated camera, rendered before it runs so that it can send thousands a
// second: a stretch of motion there and back, without end. Exposure k begins `delay_ns(k)` late;
// the pattern is where it really is at that moment, so that the truth stays the truth.
// Read-only after creation: any thread.
#pragma once

#include <cstdint>
#include <utility>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "sim/motion_profile.h"
#include "sim/speckle.h"
#include "tools/simulated_loop.h"

namespace lsv::cli {

class Exposures {
 public:
  /// Frames 0 .. `frames` - 1 of `motion` at the rate of `camera`, `frames` >= 2, each up to
  /// `jitter_ns` late: less than half a period.
  static Result<Exposures> render(const sim::SpeckleConfig& camera,
                                  const sim::MotionProfile& motion, int frames,
                                  std::int64_t jitter_ns);

  const FrameFormat& format() const { return loop_.format(); }
  /// k >= 0. Lives as long as this.
  FrameView frame(std::int64_t k) const { return loop_.frame(k); }
  TrueShift position(std::int64_t k) const { return loop_.position(k); }
  std::int64_t delay_ns(std::int64_t k) const;

 private:
  Exposures(SimulatedLoop loop, std::uint64_t seed, std::int64_t jitter_ns)
      : loop_(std::move(loop)), seed_(seed), jitter_ns_(jitter_ns) {}

  SimulatedLoop loop_;
  std::uint64_t seed_;
  std::int64_t jitter_ns_;
};

}  // namespace lsv::cli
