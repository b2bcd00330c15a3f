// SPDX-License-Identifier: BSD-3-Clause
#include "bench/accuracy_pair.h"

namespace lsv::bench {
namespace {

void require(const Result<void>& done) {
  if (!done) throw std::runtime_error(done.error().message);
}

}  // namespace

SimulatedPair render(const sim::SpeckleConfig& config, const cli::TrueShift& shift) {
  sim::SpeckleCamera camera = require_value(sim::SpeckleCamera::create(config));
  SimulatedPair out;
  out.truth = shift;
  const sim::PatternMotion before{0.0, 0.0, shift.dx_px, shift.dy_px};
  const sim::PatternMotion after{shift.dx_px, shift.dy_px, shift.dx_px, shift.dy_px};
  require(camera.render_intensity(0, before, out.light));
  require(camera.render(0, before, out.earlier));
  require(camera.render(1, after, out.later));
  return out;
}

}  // namespace lsv::bench
