// SPDX-License-Identifier: BSD-3-Clause
// The stages of a push one by one, called as the odometer calls them.
#include <cmath>
#include <cstdlib>
#include <memory>
#include <utility>

#include "bench/answers.h"
#include "bench/frames.h"
#include "bench/lsv_bench.h"
#include "correlation/correlator.h"
#include "correlation/peak.h"
#include "correlation/quality.h"

namespace lsv::bench {
namespace {

constexpr Engine kEngines[] = {Engine::zncc, Engine::cross, Engine::phase, Engine::direct};
constexpr PeakFit kFits[] = {PeakFit::sinc, PeakFit::gaussian2d, PeakFit::gaussian3,
                             PeakFit::parabola3};

/// A correlator with the first pair of frames, 0 and 1, prepared.
struct Pair {
  const cli::SimulatedLoop& loop;
  std::unique_ptr<Correlator> correlator;
  PreparedFrame earlier;
  PreparedFrame later;
  CorrelationPlane plane;

  Pair(Engine engine, int side_px)
      : loop(frames(side_px, 8)),
        correlator(make_correlator(track_config(engine).correlation, loop.format()).value()),
        earlier(correlator->make_prepared_frame()),
        later(correlator->make_prepared_frame()),
        plane(correlator->make_plane()) {
    correlator->prepare(loop.frame(0), earlier);
    correlator->prepare(loop.frame(1), later);
  }
};

void prepare(benchmark::State& state, Engine engine, int side_px) {
  Pair pair(engine, side_px);
  std::int64_t k = 1;
  for (auto _ : state) {
    std::swap(pair.earlier, pair.later);
    pair.correlator->prepare(pair.loop.frame(++k), pair.later);
  }
  pair.correlator->correlate(pair.earlier, pair.later, pair.plane);
  require(state, wrong(pair.plane, engine, PeakFit::sinc, pair.loop.shift(k)));
}

void correlate(benchmark::State& state, Engine engine, int side_px) {
  Pair pair(engine, side_px);
  for (auto _ : state) pair.correlator->correlate(pair.earlier, pair.later, pair.plane);
  require(state, wrong(pair.plane, engine, PeakFit::sinc, pair.loop.shift(1)));
}

void peak(benchmark::State& state, PeakFit fit, int side_px) {
  Pair pair(Engine::zncc, side_px);
  pair.correlator->correlate(pair.earlier, pair.later, pair.plane);
  Peak found;
  for (auto _ : state) {
    found = find_peak(pair.plane, fit);
    benchmark::DoNotOptimize(found);
  }
  require(state,
          wrong({found.dx_px, found.dy_px}, pair.loop.shift(1), tolerance_px(Engine::zncc, fit)));
}

/// The pattern does not change between the frames: what is missing to 1 is camera noise and the
/// interpolated position of the peak. Q by its definition.
std::string judge(const ShiftQuality& quality, const CorrelationPlane& plane, const Peak& top) {
  double sum_abs = 0.0;
  for (const float value : plane.values.span()) sum_abs += std::abs(static_cast<double>(value));
  const double q = top.lag_value * static_cast<double>(plane.values.size()) / sum_abs;
  if (quality.zncc > 0.95 && quality.zncc <= 1.0 && std::abs(quality.q / q - 1.0) < 1e-9) return {};
  char text[120];
  std::snprintf(text, sizeof text, "wrong answer: zncc %.4f (must be in (0.95, 1]), q %.6f (%.6f)",
                quality.zncc, quality.q, q);
  return text;
}

void quality(benchmark::State& state, int side_px) {
  Pair pair(Engine::zncc, side_px);
  pair.correlator->correlate(pair.earlier, pair.later, pair.plane);
  const Peak top = find_peak(pair.plane, PeakFit::sinc);
  const double overlap_px =
      static_cast<double>(side_px - std::abs(top.lag_dx_px)) * (side_px - std::abs(top.lag_dy_px));
  ShiftQuality measured;
  for (auto _ : state) {
    measured = measure_quality(pair.plane, top, overlap_px);
    benchmark::DoNotOptimize(measured);
  }
  require(state, judge(measured, pair.plane, top));
}

std::string name(const char* stage, std::string_view variant, int side_px) {
  return std::string(stage) + "/" + std::string(variant) + "/" + std::to_string(side_px) + "px";
}

}  // namespace

void register_stages() {
  for (const int side_px : kSizes_px) {
    for (const Engine engine : kEngines) {
      const auto add = [&](const char* stage, auto* function) {
        benchmark::RegisterBenchmark(name(stage, word(engine), side_px).c_str(), function, engine,
                                     side_px)
            ->Unit(benchmark::kMicrosecond);
      };
      add("prepare", prepare);
      add("correlate", correlate);
    }
    for (const PeakFit fit : kFits) {
      benchmark::RegisterBenchmark(name("find_peak", word(fit), side_px).c_str(), peak, fit,
                                   side_px)
          ->Unit(benchmark::kMicrosecond);
    }
    benchmark::RegisterBenchmark(name("measure_quality", "zncc", side_px).c_str(), quality, side_px)
        ->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace lsv::bench
