// SPDX-License-Identifier: BSD-3-Clause
#include "bench/frames.h"

#include <cstdio>
#include <cstdlib>
#include <map>
#include <utility>

namespace lsv::bench {

sim::SpeckleConfig camera(int side_px, int bit_depth) {
  sim::SpeckleConfig out;
  out.width_px = side_px;
  out.height_px = side_px;
  out.bit_depth = bit_depth;
  out.seed = kSeed;
  return out;
}

namespace {

using Rendered = std::map<std::pair<int, int>, cli::SimulatedLoop>;

const cli::SimulatedLoop& once(Rendered& rendered, int side_px, int bit_depth,
                               const sim::MotionProfile& motion, int count) {
  const std::pair key(side_px, bit_depth);
  if (const auto found = rendered.find(key); found != rendered.end()) return found->second;
  Result<cli::SimulatedLoop> loop =
      cli::SimulatedLoop::render(camera(side_px, bit_depth), motion, count);
  if (!loop) {
    std::fprintf(stderr, "bench: %s\n", loop.error().message.c_str());
    std::exit(EXIT_FAILURE);
  }
  return rendered.emplace(key, std::move(loop).value()).first->second;
}

}  // namespace

const cli::SimulatedLoop& frames(int side_px, int bit_depth) {
  static Rendered rendered;
  return once(rendered, side_px, bit_depth,
              sim::random_shifts(kMaxStep_px, kMaxStep_px, kFrames, kSeed), kFrames);
}

const cli::SimulatedLoop& drive(int side_px, int bit_depth) {
  static Rendered rendered;
  constexpr int kDriveFrames = 64;
  return once(rendered, side_px, bit_depth, sim::constant_velocity(kDriveX_px, kDriveY_px),
              kDriveFrames);
}

TrackConfig track_config(Engine engine) {
  TrackConfig out = cli::loop_config(camera(128, 8));
  out.correlation.engine = engine;
  return out;
}

}  // namespace lsv::bench
