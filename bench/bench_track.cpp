// SPDX-License-Identifier: BSD-3-Clause
// The shift of one frame against a keyframe, on every SIMD target of this machine.
#include <hwy/targets.h>

#include <cmath>
#include <string>

#include "bench/answers.h"
#include "bench/frames.h"
#include "bench/lsv_bench.h"
#include "correlation/kernels.h"
#include "correlation/tracker.h"

namespace lsv::bench {
namespace {

/// Forces one instruction set for as long as it lives.
class ForcedTarget {
 public:
  explicit ForcedTarget(std::int64_t target) { hwy::SetSupportedTargetsForTest(target); }
  ~ForcedTarget() { hwy::SetSupportedTargetsForTest(0); }
  ForcedTarget(const ForcedTarget&) = delete;
  ForcedTarget& operator=(const ForcedTarget&) = delete;
};

struct Case {
  Refinement refinement;
  std::int64_t target;
  int side_px;
  int bit_depth;
};

TrackFrame loaded(const FrameView& view) {
  TrackFrame out(view.format);
  out.load(view);
  return out;
}

std::string judge(const Shift& shift, Refinement refinement, const cli::TrueShift& truth) {
  if (shift.status != ShiftStatus::ok)
    return "wrong answer: shift refused as " + std::string(word(shift.status));
  const double tolerance_px = refinement == Refinement::icgn ? 0.01 : 0.06;
  return wrong({shift.dx_px, shift.dy_px}, truth, tolerance_px);
}

/// The guess is the truth to whole pixels, as a prediction would be.
void measure(benchmark::State& state, const Case& c) {
  const ForcedTarget forced(c.target);
  if (kernels::simd_target() != hwy::TargetName(c.target))
    return require(state, "another SIMD target is in force");
  const cli::SimulatedLoop& loop = frames(c.side_px, c.bit_depth);
  const TrackFrame earlier = loaded(loop.frame(0)), later = loaded(loop.frame(1));
  const cli::TrueShift truth = loop.shift(1);
  const double guess_dx_px = std::round(truth.dx_px), guess_dy_px = std::round(truth.dy_px);
  Tracker tracker(loop.format(), c.refinement, camera(c.side_px, c.bit_depth).noise_sd_counts);
  TrackReference reference(loop.format());
  tracker.build(earlier, reference);
  TrackedShift tracked;
  for (auto _ : state) {
    tracked = tracker.measure(earlier, reference, later, guess_dx_px, guess_dy_px);
    benchmark::DoNotOptimize(tracked);
  }
  require(state, judge(tracked.shift, c.refinement, truth));
}

void add(const Case& c) {
  const std::string name = std::string("track/") +
                           (c.refinement == Refinement::icgn ? "precise/" : "fast/") +
                           hwy::TargetName(c.target) + "/" + std::to_string(c.side_px) + "px/" +
                           std::to_string(c.bit_depth) + "bit";
  benchmark::RegisterBenchmark(name.c_str(), measure, c)->Unit(benchmark::kMicrosecond);
}

}  // namespace

void register_tracks() {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    for (const int side_px : kSizes_px) {
      for (const int bit_depth : {8, 16}) {
        for (const Refinement refinement : {Refinement::icgn, Refinement::none})
          add({refinement, target, side_px, bit_depth});
      }
    }
  }
}

}  // namespace lsv::bench
