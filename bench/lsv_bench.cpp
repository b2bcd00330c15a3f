// SPDX-License-Identifier: BSD-3-Clause
// Times every stage, the whole push and the OpenCV methods on the same simulated frames, and checks
// every answer against the truth.
#include "bench/lsv_bench.h"

#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/core/version.hpp>

#include "bench/frames.h"
#include "correlation/fft.h"
#include "correlation/kernels.h"
#include "tools/cpu_model.h"

namespace lsv::bench {
namespace {

bool any_failed = false;

void add_context() {
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return std::string(text);
  };
  const sim::SpeckleConfig frame = camera(128, 8);
  const TrackConfig track = track_config();
  const auto add = [](const char* key, const std::string& value) {
    benchmark::AddCustomContext(key, value);
  };
  add("cpu_model", cli::cpu_model());
  add("compiler", LSV_COMPILER);
  add("simd_target", std::string(kernels::simd_target()));
  add("fft_backend", std::string(fft_backend()));
  add("opencv_version", CV_VERSION);
  add("opencv_threads", std::to_string(cv::getNumThreads()));
  add("frames_seed", std::to_string(kSeed));
  add("frames_cycled", std::to_string(kFrames));
  add("max_step_px", number(kMaxStep_px));
  add("speckle_px", number(frame.speckle_px));
  add("rho", number(frame.rho));
  add("exposure_ratio", number(frame.exposure_ratio));
  add("mean_signal_counts_8bit", number(sim::mean_signal_counts(frame)));
  add("noise_mean_counts", number(frame.noise_mean_counts));
  add("noise_sd_counts", number(frame.noise_sd_counts));
  add("max_shift_px", track.correlation.max_shift_px
                          ? std::to_string(*track.correlation.max_shift_px)
                          : "32 or half the frame");
  add("default_engine", std::string(word(track.correlation.engine)));
  add("default_peak_fit", std::string(word(track.correlation.peak_fit)));
}

}  // namespace

void require(benchmark::State& state, const std::string& complaint) {
  if (complaint.empty()) return;
  any_failed = true;
  state.SkipWithError(complaint.c_str());
}

}  // namespace lsv::bench

int main(int argc, char** argv) {
  using namespace lsv::bench;
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return EXIT_FAILURE;
  add_context();
  register_stages();
  register_pushes();
  register_tracks();
  register_opencv();
  register_fusion();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return any_failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
