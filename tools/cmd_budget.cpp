// SPDX-License-Identifier: BSD-3-Clause
// `lsv budget`: does this machine keep up with a camera of a given rate and frame size?
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "correlation/correlator.h"
#include "correlation/fft.h"
#include "correlation/kernels.h"
#include "lsv/output/output_file.h"
#include "tools/budget_report.h"
#include "tools/commands.h"
#include "tools/cpu_model.h"
#include "tools/interrupt.h"
#include "tools/size_option.h"

namespace lsv::cli {
namespace {

constexpr std::size_t kMaxFrames = 1'000'000;  // every sample is kept: 8 bytes each
constexpr int kExitTooSlow = kExitLowQuality;

constexpr const char* kFooter =
    "Runs the whole pipeline on simulated frames held in memory: first as fast as it goes, then "
    "with\n"
    "one frame due every 1/rate. A rate holds when 99.9 % of the results are there before the "
    "next\n"
    "frame is due. Camera and storage are not part of it.\n"
    "\n"
    "Example:\n"
    "  lsv budget --rate-hz 1000 --size 128x128 --seconds 10\n"
    "Exit codes: 0 the rate holds, 1 output not written, 2 usage, 4 it does not, 130 interrupted.";

struct BudgetOptions {
  double rate_hz = 0.0;
  std::string size = "128x128";
  int bit_depth = 8;
  std::string preset{word(TrackConfig{}.preset)};
  std::string engine{word(CorrelationConfig{}.engine)};
  std::string peak_fit{word(CorrelationConfig{}.peak_fit)};
  int max_shift_px = 0;
  std::int64_t frames = 0;  // 0: from seconds
  double seconds = 5.0;
  std::string json_path;
};

Error usage(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

Result<sim::SpeckleConfig> simulated_camera(const BudgetOptions& options) {
  if (!(options.rate_hz > 0.0 && options.rate_hz <= 1e6))
    return usage("--rate-hz must be above 0 and at most 1e6");
  sim::SpeckleConfig camera;
  camera.frame_rate_hz = options.rate_hz;
  camera.bit_depth = options.bit_depth;
  if (auto parsed = parse_size(options.size, camera); !parsed) return parsed.error();
  if (auto valid = sim::validate(camera); !valid) return valid.error();
  return camera;
}

Result<CorrelationConfig> correlation_config(const BudgetOptions& options, bool has_max_shift) {
  const auto engine = engine_from(options.engine);
  if (!engine)
    return usage("--engine is \"" + options.engine + "\" but must be zncc, cross, phase or direct");
  const auto peak_fit = peak_fit_from(options.peak_fit);
  if (!peak_fit) {
    return usage("--peak-fit is \"" + options.peak_fit +
                 "\" but must be sinc, gaussian2d, gaussian3 or parabola3");
  }
  CorrelationConfig out;
  out.engine = *engine;
  out.peak_fit = *peak_fit;
  if (has_max_shift) out.max_shift_px = options.max_shift_px;
  return out;
}

Result<std::size_t> frame_count(const BudgetOptions& options, bool has_frames) {
  const double frames = has_frames ? static_cast<double>(options.frames)
                                   : std::ceil(options.seconds * options.rate_hz);
  if (frames >= 1.0 && frames <= static_cast<double>(kMaxFrames))
    return static_cast<std::size_t>(frames);
  char count[32];
  std::snprintf(count, sizeof count, "%.0f", frames);
  return usage(std::string(has_frames ? "--frames asks" : "--seconds at this rate asks") + " for " +
               count + " frames but must ask for 1 to " + std::to_string(kMaxFrames));
}

/// Far enough inside the search range that no peak stands at its border.
double largest_step_px(const LagRange& lags) {
  return std::min(5.0, 0.5 * (std::min(lags.max_dx_px, lags.max_dy_px) - 1));
}

Result<void> write_budget(const Budget& budget, const std::string& json_path) {
  if (json_path != "-") {
    if (Result<void> written = write_file("-", budget_text(budget)); !written) return written;
  }
  if (json_path.empty()) return {};
  return write_file(json_path, budget_json(budget));
}

/// The exit code.
Result<int> measure(const BudgetOptions& options, const sim::SpeckleConfig& camera,
                    const CorrelationConfig& correlation, std::size_t frames) {
  const auto preset = preset_from(options.preset);
  if (!preset)
    return usage("--preset is \"" + options.preset + "\" but must be precise, fast or classic");
  TrackConfig config = loop_config(camera);
  config.preset = *preset;
  config.correlation = correlation;
  if (Result<void> valid = validate(config); !valid) return valid.error();
  const Result<LagRange> lags = resolve_lags(correlation, sim::frame_format(camera));
  if (!lags) return lags.error();

  constexpr int kRenderedFrames = 16;
  const double max_step_px = largest_step_px(lags.value());
  const Result<SimulatedLoop> loop = SimulatedLoop::render(camera, max_step_px, kRenderedFrames);
  if (!loop) return loop.error();
  catch_interrupts();
  const double run_s = static_cast<double>(frames) / options.rate_hz;
  Result<UnpacedTimes> unpaced =
      measure_unpaced(config, loop.value(), frames, std::max(1.0, run_s));
  if (!unpaced) return unpaced.error();
  Result<PacedTimes> paced = measure_paced(config, loop.value(), frames, options.rate_hz);
  if (!paced) return paced.error();
  if (interrupted()) return kExitInterrupted;
  const Budget budget{.cpu_model = cpu_model(),
                      .simd_target = std::string(kernels::simd_target()),
                      .fft_backend = std::string(fft_backend()),
                      .rate_hz = options.rate_hz,
                      .format = loop.value().format(),
                      .preset = *preset,
                      .max_step_px = max_step_px,
                      .correlation = correlation,
                      .lags = lags.value(),
                      .unpaced = unpaced.value(),
                      .paced = paced.value()};
  if (Result<void> written = write_budget(budget, options.json_path); !written)
    return written.error();
  return budget.paced.holds() ? kExitOk : kExitTooSlow;
}

int run(const CLI::App& command, const BudgetOptions& options) {
  const auto camera = simulated_camera(options);
  if (!camera) return report_error(camera.error());
  const auto correlation = correlation_config(options, command.count("--max-shift") > 0);
  if (!correlation) return report_error(correlation.error());
  const auto frames = frame_count(options, command.count("--frames") > 0);
  if (!frames) return report_error(frames.error());
  const Result<int> exit_code =
      measure(options, camera.value(), correlation.value(), frames.value());
  return exit_code ? exit_code.value() : report_error(exit_code.error());
}

}  // namespace

void add_budget_command(CLI::App& app, int& exit_code) {
  CLI::App* const sub =
      app.add_subcommand("budget", "Measure whether this machine keeps up with a frame rate");
  const auto options = std::make_shared<BudgetOptions>();
  BudgetOptions& o = *options;
  sub->add_option("--rate-hz", o.rate_hz, "Frames per second that must be kept up with")
      ->required();
  sub->add_option("--size", o.size, "Width x height of the frames, px")->capture_default_str();
  CLI::Option* const frames =
      sub->add_option("--frames", o.frames, "Number of frames (instead of --seconds)");
  sub->add_option("--seconds", o.seconds, "Length of the paced run")
      ->capture_default_str()
      ->excludes(frames);
  sub->add_option("--bit-depth", o.bit_depth, "8, 10, 12 or 16")->capture_default_str();
  sub->add_option("--preset", o.preset, "precise, fast or classic")->capture_default_str();
  sub->add_option("--engine", o.engine, "zncc, cross, phase or direct")->capture_default_str();
  sub->add_option("--peak-fit", o.peak_fit, "sinc, gaussian2d, gaussian3 or parabola3")
      ->capture_default_str();
  sub->add_option("--max-shift", o.max_shift_px,
                  "Largest shift searched along each axis, px; unset: 32 or half the frame");
  sub->add_option("--json", o.json_path,
                  "Also write the numbers as JSON; - for only that, on "
                  "standard output");
  sub->footer(kFooter);
  sub->callback([sub, options, &exit_code] { exit_code = run(*sub, *options); });
}

}  // namespace lsv::cli
