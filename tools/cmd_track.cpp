// SPDX-License-Identifier: BSD-3-Clause
// lsv track: frames in, calibrated track out.
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <utility>

#include "calibration/calibration_io.h"
#include "lsv/odometer.h"
#include "lsv/output/number_text.h"
#include "tools/calibrated_frames.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/progress.h"
#include "tools/settings.h"
#include "tools/track_outputs.h"
#include "tools/track_settings.h"

namespace lsv::cli {
namespace {

struct TrackCommand {
  std::vector<std::string> frames;
  std::string config_path;
  bool print_config = false;
  bool quiet = false;
  OutputPaths outputs;
  TrackSettings track;
  Settings settings;
};

std::string time_base(const SourceOptions& source) {
  if (!source.rate_hz && source.timestamps_path.empty()) return "recording";
  if (!source.rate_hz) return source.timestamps_path;
  char text[40];
  std::snprintf(text, sizeof text, "%.10g Hz", *source.rate_hz);
  return text;
}

RunInfo run_info(const TrackSettings& track, const SourceInfo& source, const LagRange& lags) {
  RunInfo info;
  info.version = LSV_VERSION;
  info.source_description = source.description;
  info.format = source.format;
  info.time_base = time_base(track.source);
  info.config = track.config;
  info.max_shift = lags;
  info.index_step = track.source.step;
  return info;
}

/// Every frame of `source` through `odometer` to `outputs`, until the end or an interrupt.
Result<void> track_frames(FrameSource& source, Odometer& odometer, TrackOutputs& outputs,
                          Progress& progress) {
  Frame frame;
  while (!interrupted()) {
    const Result<bool> more = source.next(frame);
    if (!more && interrupted()) break;  // the signal ended the wait for a pipe
    if (!more) return more.error();
    if (!more.value()) break;
    const Result<StepReport> report = odometer.push(frame.view());
    if (!report) return report.error();
    if (Result<void> written = outputs.write(report.value(), frame.view(), odometer); !written)
      return written;
    const ShiftStatus status = report.value().shift.status;
    progress.frame_done(status != ShiftStatus::ok && status != ShiftStatus::first_frame);
  }
  return {};
}

/// `error` with the input it is about.
Error about(const std::string& input, const Error& error) {
  return {error.code, input + ": " + error.message};
}

Result<int> track(TrackCommand& command) {
  if (command.frames.empty()) {
    return Error{ErrorCode::invalid_argument,
                 "no frames: name a folder, files, a TIFF stack or '-'; see lsv track --help"};
  }
  TrackSettings& settings = command.track;
  if (!(settings.max_rejected_share >= 0.0 && settings.max_rejected_share <= 1.0))
    return Error{ErrorCode::invalid_argument, "--max-rejected must be between 0 and 1"};
  if (settings.calibration_path.empty()) {
    return Error{ErrorCode::invalid_argument,
                 "a calibration is needed to turn pixels into metres: give --calibration FILE "
                 "(sample_frames/calibration.toml is an example)"};
  }
  Result<std::unique_ptr<FrameSource>> source = open_calibrated_frames(command.frames, settings);
  if (!source) return source.error();
  const SourceInfo& info = source.value()->info();
  Result<Odometer> odometer = Odometer::create(settings.config, info.format);
  if (!odometer) return about(command.frames.front(), odometer.error());
  std::vector<std::string> inputs = inputs_of(info, settings);
  if (!command.config_path.empty()) inputs.push_back(command.config_path);
  Result<TrackOutputs> outputs =
      TrackOutputs::open(command.outputs, run_info(settings, info, odometer.value().lags()),
                         command.settings.to_toml(), inputs);
  if (!outputs) return outputs.error();

  catch_interrupts();
  {
    Progress progress(info.frame_count, command.quiet);
    if (Result<void> tracked =
            track_frames(*source.value(), odometer.value(), outputs.value(), progress);
        !tracked)
      return tracked.error();
  }
  if (!interrupted() && outputs.value().summary().frames < 2)
    return Error{ErrorCode::bad_input,
                 command.frames.front() + ": a track needs at least two frames; there is only one"};
  if (Result<void> finished = outputs.value().finish({.interrupted = interrupted()}); !finished)
    return finished.error();
  if (outputs.value().lacks_report_frame()) {
    std::fprintf(stderr,
                 "lsv: warning: --report-frame: no pair ending at that frame was correlated\n");
  }
  const Summary summary = outputs.value().summary();
  if (!command.quiet) std::fputs(summary_text(summary).c_str(), stderr);
  return exit_code_of(summary, settings.max_rejected_share);
}

/// The settings that come from the calibration file, as comments of the printed configuration.
std::string calibration_comment(const Calibration& calibration, const std::string& path) {
  const std::pair<const char*, double> numbers[] = {
      {"pixel_pitch_x_m", calibration.pixel_pitch_x_m},
      {"pixel_pitch_y_m", calibration.pixel_pitch_y_m},
      {"sc_x_ratio", calibration.sc_x_ratio},
      {"sc_y_ratio", calibration.sc_y_ratio},
      {"noise_mean_counts", calibration.noise_mean_counts},
      {"noise_sd_counts", calibration.noise_sd_counts}};
  std::string out;
  for (const auto& [key, value] : numbers) {
    out += std::string("# calibration: ") + key + " = ";
    append_shortest(out, value);
    out += "  # " + path + "\n";
  }
  return out;
}

int print_config(TrackCommand& command) {
  std::string text = command.settings.to_toml();
  if (const std::string& path = command.track.calibration_path; !path.empty()) {
    const Result<Calibration> calibration = load_calibration(path);
    if (!calibration) return report_error(calibration.error());
    text += calibration_comment(calibration.value(), path);
  }
  std::fputs(text.c_str(), stdout);
  return std::fflush(stdout) == 0 ? kExitOk : kExitOutputFailed;
}

int run(TrackCommand& command) {
  if (Result<void> resolved = command.settings.resolve(command.config_path); !resolved)
    return report_error(resolved.error());
  if (command.print_config) return print_config(command);
  const Result<int> tracked = track(command);
  return tracked ? tracked.value() : report_error(tracked.error());
}

}  // namespace

void add_track_command(CLI::App& app, int& exit_code) {
  auto command = std::make_shared<TrackCommand>();
  CLI::App* const sub =
      app.add_subcommand("track", "Track the speckle pattern through frames: velocity, position");
  sub->add_option("FRAMES", command->frames, kFramesHelp);
  add_output_options(*sub, command->outputs);
  sub->add_option("--config", command->config_path, "Settings from a TOML file");
  sub->add_flag("--print-config", command->print_config,
                "Print every setting with its source and stop");
  sub->add_flag("-q,--quiet", command->quiet, "No progress and no summary on stderr");
  add_track_settings(*sub, command->settings, command->track);
  sub->footer(
      "Example:\n"
      "  lsv track sample_frames/drive.tif --rate-hz 1000 \\\n"
      "      --calibration sample_frames/calibration.toml -o out\n"
      "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input, 4 too many shifts refused, "
      "130 interrupted.");
  sub->callback([command, sub, &exit_code] {
    const Result<void> named = refuse_empty_names(*sub);
    exit_code = named ? run(*command) : report_error(named.error());
  });
}

}  // namespace lsv::cli
