// SPDX-License-Identifier: BSD-3-Clause
// The whole pipeline: one frame in, one step report out.
#include <string>

#include "bench/answers.h"
#include "bench/frames.h"
#include "bench/lsv_bench.h"
#include "lsv/odometer.h"

namespace lsv::bench {
namespace {

std::string judge(const Shift& shift, const CorrelationConfig& used, const CorrelationPlane& plane,
                  const cli::TrueShift& truth) {
  if (used.engine == Engine::phase) return wrong(plane, used.engine, used.peak_fit, truth);
  if (shift.status != ShiftStatus::ok)
    return "wrong answer: shift refused as " + std::string(word(shift.status));
  return wrong({shift.dx_px, shift.dy_px}, truth, tolerance_px(used.engine, used.peak_fit));
}

void push(benchmark::State& state, Engine engine, int side_px, int bit_depth) {
  const cli::SimulatedLoop& loop = frames(side_px, bit_depth);
  const TrackConfig config = track_config(engine);
  Odometer odometer = Odometer::create(config, loop.format()).value();
  std::int64_t k = 0;
  Result<StepReport> report = odometer.push(loop.frame(k));
  for (auto _ : state) report = odometer.push(loop.frame(++k));
  require(state,
          report ? judge(report.value().shift, config.correlation, odometer.plane(), loop.shift(k))
                 : report.error().message);
}

void add(Engine engine, int side_px, int bit_depth) {
  const std::string name = "push/" + std::string(word(engine)) + "/" + std::to_string(side_px) +
                           "px/" + std::to_string(bit_depth) + "bit";
  benchmark::RegisterBenchmark(name.c_str(), push, engine, side_px, bit_depth)
      ->Unit(benchmark::kMicrosecond);
}

}  // namespace

void register_pushes() {
  for (const int side_px : kSizes_px) {
    add(Engine::zncc, side_px, 8);
    add(Engine::zncc, side_px, 16);
    for (const Engine engine : {Engine::cross, Engine::phase, Engine::direct})
      add(engine, side_px, 8);
  }
}

}  // namespace lsv::bench
