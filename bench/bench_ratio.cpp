// SPDX-License-Identifier: BSD-3-Clause
// How much faster than cv::phaseCorrelate is one lsv push? Both are timed in turns on the same
// pair of frames, so that both see the machine in the same state. Fails when an answer is wrong,
// never because of speed.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <opencv2/core/version.hpp>
#include <utility>
#include <vector>

#include "bench/opencv_methods.h"
#include "correlation/fft.h"
#include "correlation/kernels.h"
#include "lsv/odometer.h"
#include "tools/cpu_model.h"
#include "tools/duration_samples.h"

namespace lsv::bench {
namespace {

constexpr int kWarmUpRounds = 20;

struct Method {
  std::vector<std::int64_t> times_ns;
  double largest_error_px = 0.0;
  bool refused = false;

  template <typename Call>
  void time(const cli::TrueShift& truth, bool counted, Call call) {
    const std::int64_t start_ns = cli::clock_now_ns();
    const Answer answer = call();
    const std::int64_t end_ns = cli::clock_now_ns();
    if (counted) times_ns.push_back(end_ns - start_ns);
    const double error_px =
        std::max(std::abs(answer.dx_px - truth.dx_px), std::abs(answer.dy_px - truth.dy_px));
    if (std::isnan(error_px)) refused = true;
    largest_error_px = std::max(largest_error_px, error_px);
  }

  bool right(double tolerance_px) const { return !refused && largest_error_px <= tolerance_px; }
  double fastest_us() const {
    return static_cast<double>(*std::min_element(times_ns.begin(), times_ns.end())) / 1e3;
  }
  double median_us() {
    const auto middle = times_ns.begin() + static_cast<std::ptrdiff_t>(times_ns.size() / 2);
    std::nth_element(times_ns.begin(), middle, times_ns.end());
    return static_cast<double>(*middle) / 1e3;
  }
};

struct Comparison {
  Method push;
  Method phase_correlate;
};

Comparison compare(int side_px, int rounds) {
  const cli::SimulatedLoop& loop = frames(side_px, 8);
  const OpenCvFrames images(loop);
  PhaseCorrelate opencv(side_px, true);
  Odometer odometer = Odometer::create(track_config(), loop.format()).value();
  Comparison out;
  (void)odometer.push(loop.frame(0));
  for (int k = 1; k <= rounds + kWarmUpRounds; ++k) {
    const bool counted = k > kWarmUpRounds;
    const auto push = [&] {
      const Result<StepReport> report = odometer.push(loop.frame(k));
      return report ? Answer{report.value().shift.dx_px, report.value().shift.dy_px}
                    : Answer{kUnknown, kUnknown};
    };
    const auto phase = [&] { return opencv.shift(); };
    opencv.load(images.floats(k - 1), images.floats(k));
    // Who comes first finds the caches as the other left them: each in turn.
    if (k % 2 == 0) out.push.time(loop.shift(k), counted, push);
    out.phase_correlate.time(loop.shift(k), counted, phase);
    if (k % 2 != 0) out.push.time(loop.shift(k), counted, push);
  }
  return out;
}

void print_head(int rounds) {
  const TrackConfig config = track_config();
  std::printf("machine    %s; SIMD %s, FFT %s, OpenCV %s on 1 thread\n", cli::cpu_model().c_str(),
              std::string(kernels::simd_target()).c_str(), std::string(fft_backend()).c_str(),
              CV_VERSION);
  std::printf("frames     simulated speckle of %g px, 8 bit, shifts up to %g px, seed %llu\n",
              camera(128, 8).speckle_px, kMaxStep_px, static_cast<unsigned long long>(kSeed));
  std::printf(
      "lsv push   8-bit frame to report: engine %s, peak fit %s, lags +-32 px, quality,\n"
      "           covariance, gate, velocity, position\n",
      std::string(word(config.correlation.engine)).c_str(),
      std::string(word(config.correlation.peak_fit)).c_str());
  std::printf("opencv     cv::phaseCorrelate with a Hann window; float32 frames made beforehand\n");
  std::printf("rounds     %d per size, in turns\n\n", rounds);
  std::printf("%6s  %22s  %22s  %17s  %20s\n", "", "lsv push, us", "phaseCorrelate, us", "ratio",
              "largest error, px");
  std::printf("%6s  %11s%11s  %11s%11s  %8s%9s  %10s%10s\n", "size", "median", "fastest", "median",
              "fastest", "median", "fastest", "lsv", "opencv");
}

/// False when an answer is wrong.
bool report(int side_px, Comparison& c) {
  const double push_us = c.push.median_us();
  const double phase_us = c.phase_correlate.median_us();
  std::printf("%6d  %11.1f%11.1f  %11.1f%11.1f  %8.2f%9.2f  %10.4f%10.4f\n", side_px, push_us,
              c.push.fastest_us(), phase_us, c.phase_correlate.fastest_us(), phase_us / push_us,
              c.phase_correlate.fastest_us() / c.push.fastest_us(), c.push.largest_error_px,
              c.phase_correlate.largest_error_px);
  std::fflush(stdout);
  const CorrelationConfig used = track_config().correlation;
  const double push_tolerance_px = tolerance_px(used.engine, used.peak_fit);
  const bool push_right = c.push.right(push_tolerance_px);
  const bool phase_right = c.phase_correlate.right(PhaseCorrelate::kTolerance_px);
  if (!push_right)
    std::fprintf(stderr, "bench_ratio: lsv is wrong by more than %g px at %d px\n",
                 push_tolerance_px, side_px);
  if (!phase_right)
    std::fprintf(stderr, "bench_ratio: phaseCorrelate is wrong by more than %g px at %d px\n",
                 PhaseCorrelate::kTolerance_px, side_px);
  return push_right && phase_right;
}

int run(int rounds) {
  cv::setNumThreads(1);
  print_head(rounds);
  bool all_right = true;
  for (const int side_px : kSizes_px) {
    Comparison compared = compare(side_px, rounds);
    all_right = report(side_px, compared) && all_right;
  }
  return all_right ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace lsv::bench

int main(int argc, char** argv) {
  int rounds = 2000;
  const char* const end = argc == 2 ? argv[1] + std::strlen(argv[1]) : nullptr;
  if (argc > 2 || (argc == 2 && (std::from_chars(argv[1], end, rounds).ptr != end || rounds < 1))) {
    std::fputs("usage: bench_ratio [ROUNDS]\n", stderr);
    return 2;
  }
  return lsv::bench::run(rounds);
}
