// SPDX-License-Identifier: BSD-3-Clause
#include "tools/camera_simulator/exposures.h"

#include <cmath>

#include "sim/philox.h"

namespace lsv::cli {
namespace {

/// By how much frame `k` of the stretch is off the middle of its jitter, [-1/2, 1/2] of it; none
/// at the ends, where the motion turns.
double off_middle(std::uint64_t seed, std::int64_t k, std::int64_t frames) {
  if (k == 0 || k == frames - 1) return 0.0;
  return sim::uniform_pair(seed, sim::Stream::exposure_jitter, k, 0, 0)[0] - 0.5;
}

/// Where the pattern is a fraction of a frame before or after frame `k`.
sim::PatternMotion shortly_after(const sim::MotionProfile& motion, std::int64_t k,
                                 double frame_ratio) {
  sim::PatternMotion at = motion(k);
  if (frame_ratio == 0.0) return at;
  const sim::PatternMotion beside = motion(frame_ratio > 0.0 ? k + 1 : k - 1);
  const double ratio = std::abs(frame_ratio);
  at.x_px += ratio * (beside.x_px - at.x_px);
  at.y_px += ratio * (beside.y_px - at.y_px);
  return at;
}

}  // namespace

Result<Exposures> Exposures::render(const sim::SpeckleConfig& camera,
                                    const sim::MotionProfile& motion, int frames,
                                    std::int64_t jitter_ns) {
  const double jitter_ratio =
      static_cast<double>(jitter_ns) / static_cast<double>(kNsPerS) * camera.frame_rate_hz;
  const auto jittered = [&](std::int64_t k) {
    return shortly_after(motion, k, jitter_ratio * off_middle(camera.seed, k, frames));
  };
  Result<SimulatedLoop> loop = SimulatedLoop::render(camera, jittered, frames);
  if (!loop) return loop.error();
  return Exposures(std::move(loop).value(), camera.seed, jitter_ns);
}

std::int64_t Exposures::delay_ns(std::int64_t k) const {
  const int frames = loop_.frame_count();
  const auto in_stretch =
      static_cast<std::int64_t>(there_and_back(k, static_cast<std::size_t>(frames)));
  const bool on_the_way_back = k % (2 * (frames - 1)) > frames - 1;
  const double off = off_middle(seed_, in_stretch, frames);
  // On the way back time runs the other way through the stretch.
  return std::llround(static_cast<double>(jitter_ns_) * (0.5 + (on_the_way_back ? -off : off)));
}

}  // namespace lsv::cli
