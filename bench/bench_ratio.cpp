// SPDX-License-Identifier: BSD-3-Clause
// How much faster than cv::phaseCorrelate is one lsv push in a steady drive, by preset? All are
// timed in turns on the same frames, so that each sees the machine in the same state. Fails when an
// answer is wrong, never because of speed.
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
constexpr int kBlock = 20;

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

struct Contender {
  Preset preset;
  double tolerance_px;
  Odometer odometer;
  Method method{};
};

std::vector<Contender> contenders(const FrameFormat& format) {
  std::vector<Contender> out;
  for (const auto& [preset, tolerance_px] :
       {std::pair{Preset::fast, 0.05}, {Preset::precise, 0.01}, {Preset::classic, 0.02}}) {
    TrackConfig config = track_config();
    config.preset = preset;
    out.push_back({preset, tolerance_px, Odometer::create(config, format).value()});
  }
  return out;
}

struct Comparison {
  std::vector<Contender> lsv;
  Method phase_correlate;
};

Comparison compare(int side_px, int bit_depth, int rounds) {
  const cli::SimulatedLoop& loop = drive(side_px, bit_depth);
  const cli::SimulatedLoop& bytes = drive(side_px, 8);
  const OpenCvFrames images(bytes);
  PhaseCorrelate opencv(side_px, true);
  Comparison out{.lsv = contenders(loop.format()), .phase_correlate = {}};
  for (Contender& c : out.lsv) (void)c.odometer.push(loop.frame(0));
  // In turns by blocks: all see the same state of the machine, and each its own data in the caches,
  // as in a program that does nothing else.
  for (int first = 1; first <= rounds + kWarmUpRounds; first += kBlock) {
    const int end = std::min(first + kBlock, rounds + kWarmUpRounds + 1);
    for (Contender& c : out.lsv) {
      for (int k = first; k < end; ++k) {
        c.method.time(loop.shift(k), k > kWarmUpRounds, [&] {
          const Result<StepReport> report = c.odometer.push(loop.frame(k));
          return report ? Answer{report.value().shift.dx_px, report.value().shift.dy_px}
                        : Answer{kUnknown, kUnknown};
        });
      }
    }
    for (int k = first; k < end; ++k) {
      opencv.load(images.floats(k - 1), images.floats(k));
      out.phase_correlate.time(bytes.shift(k), k > kWarmUpRounds, [&] { return opencv.shift(); });
    }
  }
  return out;
}

void print_head(int rounds) {
  std::printf("machine    %s; SIMD %s, FFT %s, OpenCV %s on 1 thread\n", cli::cpu_model().c_str(),
              std::string(kernels::simd_target()).c_str(), std::string(fft_backend()).c_str(),
              CV_VERSION);
  std::printf(
      "frames     simulated speckle of %g px, steady drive of (%g, %g) px a frame, seed %llu\n",
      camera(128, 8).speckle_px, kDriveX_px, kDriveY_px, static_cast<unsigned long long>(kSeed));
  std::printf("lsv push   frame to report: shift, quality, covariance, gate, velocity, position\n");
  std::printf("opencv     cv::phaseCorrelate with a Hann window; float32 frames made beforehand\n");
  std::printf("rounds     %d per line, in turns of 20; times in us, ratio of the medians\n\n",
              rounds);
  std::printf("%4s %4s  %-9s %8s %8s  %8s %8s  %7s  %10s\n", "px", "bit", "preset", "median",
              "fastest", "opencv", "fastest", "ratio", "error, px");
}

/// False when an answer is wrong.
bool report(int side_px, int bit_depth, Comparison& c) {
  const double phase_us = c.phase_correlate.median_us();
  bool all_right = true;
  for (Contender& contender : c.lsv) {
    Method& m = contender.method;
    const double push_us = m.median_us();
    std::printf("%4d %4d  %-9s %8.1f %8.1f  %8.1f %8.1f  %7.1f  %10.4f\n", side_px, bit_depth,
                std::string(word(contender.preset)).c_str(), push_us, m.fastest_us(), phase_us,
                c.phase_correlate.fastest_us(), phase_us / push_us, m.largest_error_px);
    if (m.right(contender.tolerance_px)) continue;
    all_right = false;
    std::fprintf(stderr, "bench_ratio: %s is wrong by more than %g px at %d px\n",
                 std::string(word(contender.preset)).c_str(), contender.tolerance_px, side_px);
  }
  std::fflush(stdout);
  if (!c.phase_correlate.right(PhaseCorrelate::kTolerance_px)) {
    all_right = false;
    std::fprintf(stderr, "bench_ratio: phaseCorrelate is wrong by more than %g px at %d px\n",
                 PhaseCorrelate::kTolerance_px, side_px);
  }
  return all_right;
}

int run(int rounds) {
  cv::setNumThreads(1);
  print_head(rounds);
  bool all_right = true;
  for (const int bit_depth : {8, 12}) {
    for (const int side_px : kSizes_px) {
      Comparison compared = compare(side_px, bit_depth, rounds);
      all_right = report(side_px, bit_depth, compared) && all_right;
    }
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
