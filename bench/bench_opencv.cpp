// SPDX-License-Identifier: BSD-3-Clause
// The peers, on the frames that lsv is timed on.
#include <string>

#include "bench/frames.h"
#include "bench/lsv_bench.h"
#include "bench/opencv_methods.h"
#include "tools/duration_samples.h"

namespace lsv::bench {
namespace {

void phase_correlate(benchmark::State& state, bool windowed, int side_px) {
  const cli::SimulatedLoop& loop = frames(side_px, 8);
  const OpenCvFrames images(loop);
  PhaseCorrelate method(side_px, windowed);
  std::int64_t k = 0;
  Answer answer;
  for (auto _ : state) {
    ++k;
    method.load(images.floats(k - 1), images.floats(k));
    const std::int64_t start_ns = cli::clock_now_ns();
    answer = method.shift();
    state.SetIterationTime(static_cast<double>(cli::clock_now_ns() - start_ns) / 1e9);
  }
  require(state, wrong(answer, loop.shift(k), PhaseCorrelate::kTolerance_px));
}

void match_template(benchmark::State& state, int side_px) {
  const cli::SimulatedLoop& loop = frames(side_px, 8);
  const OpenCvFrames images(loop);
  TemplateMatch method(side_px);
  std::int64_t k = 0;
  Answer answer;
  for (auto _ : state) {
    ++k;
    answer = method.shift(images.bytes(k - 1), images.bytes(k));
  }
  state.SetLabel("template " + std::to_string(method.template_px()) + " px, lags +-" +
                 std::to_string(method.range_px()) + " px");
  require(state, wrong(answer, loop.shift(k), TemplateMatch::kTolerance_px));
}

}  // namespace

void register_opencv() {
  for (const int side_px : kSizes_px) {
    const std::string size = std::to_string(side_px) + "px";
    for (const bool windowed : {true, false}) {
      const std::string name =
          std::string("opencv_phase_correlate/") + (windowed ? "hann/" : "no_window/") + size;
      benchmark::RegisterBenchmark(name.c_str(), phase_correlate, windowed, side_px)
          ->UseManualTime()
          ->Unit(benchmark::kMicrosecond);
    }
    benchmark::RegisterBenchmark(("opencv_match_template/ccoeff_normed/" + size).c_str(),
                                 match_template, side_px)
        ->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace lsv::bench
