// SPDX-License-Identifier: BSD-3-Clause
// lsv replay: a recording through the odometer again, with the settings that it holds.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "calibration/calibration_io.h"
#include "calibration/sensor_maps_io.h"
#include "lsv/ingest/recording.h"
#include "lsv/odometer.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/progress.h"
#include "tools/replay_check.h"
#include "tools/settings.h"
#include "tools/track_outputs.h"
#include "tools/track_settings.h"

namespace lsv::cli {
namespace {

struct ReplayCommand {
  std::string recording;
  bool quiet = false;
  OutputPaths outputs;
};

/// The settings that `notes` hold, as the odometer had them.
Result<TrackConfig> recorded_config(const RecordingNotes& notes, const std::string& recording) {
  if (!notes.config_toml || !notes.calibration_toml) {
    return Error{ErrorCode::bad_input,
                 recording + ": holds no settings of lsv; use lsv track with --calibration"};
  }
  CLI::App no_flags;
  Settings settings;
  TrackSettings track;
  add_track_settings(no_flags, settings, track);
  if (Result<void> resolved =
          settings.resolve_recorded(*notes.config_toml, recording + ", config.toml");
      !resolved)
    return resolved.error();
  const std::string name = recording + ", calibration.toml";
  Result<Calibration> calibration = parse_calibration(*notes.calibration_toml, name);
  if (!calibration) return calibration.error();
  track.config.calibration = std::move(calibration).value();
  if (notes.sensor_maps_tiff.empty()) return track.config;
  Result<SensorMaps> maps =
      parse_sensor_maps(mcap::text_of(notes.sensor_maps_tiff), recording + ", sensor_maps.tif");
  if (!maps) return maps.error();
  track.config.sensor_maps = std::make_shared<const SensorMaps>(std::move(maps).value());
  return track.config;
}

RunInfo run_info(const RecordingNotes& notes, const TrackConfig& config, const FrameFormat& format,
                 const LagRange& lags) {
  RunInfo info;
  info.version = LSV_VERSION;
  info.source_description = "recording of " + notes.source;
  info.format = format;
  info.time_base = "recording";
  info.config = config;
  info.max_shift = lags;
  return info;
}

Result<int> replay(ReplayCommand& command) {
  const std::string& path = command.recording;
  Result<RecordingReader> opened =
      RecordingReader::open(path, {.max_pixels = SourceOptions{}.max_pixels});
  if (!opened) return opened.error();
  RecordingReader& reader = opened.value();
  RecordedFrame recorded;
  Result<bool> more = reader.next(recorded);
  if (!more) return more.error();
  if (!more.value()) return Error{ErrorCode::bad_input, path + ": holds no frame"};
  Result<TrackConfig> config = recorded_config(reader.notes(), path);
  if (!config) return config.error();
  const FrameFormat format = recorded.frame.view().format;
  Result<Odometer> odometer = Odometer::create(config.value(), format);
  if (!odometer) return Error{ErrorCode::bad_input, path + ": " + odometer.error().message};
  Result<TrackOutputs> outputs = TrackOutputs::open(
      command.outputs, run_info(reader.notes(), config.value(), format, odometer.value().lags()),
      *reader.notes().config_toml, {path});
  if (!outputs) return outputs.error();

  catch_interrupts();
  ReplayCheck check;
  {
    Progress progress(std::nullopt, command.quiet);
    while (more.value() && !interrupted()) {
      const FrameView frame = recorded.frame.view();
      const Result<StepReport> report = odometer.value().push(frame);
      if (!report) return Error{ErrorCode::bad_input, path + ": " + report.error().message};
      check.compare(recorded, report.value());
      if (Result<void> written = outputs.value().write(report.value(), frame, odometer.value());
          !written)
        return written.error();
      const ShiftStatus status = report.value().shift.status;
      progress.frame_done(status != ShiftStatus::ok && status != ShiftStatus::first_frame);
      more = reader.next(recorded);
      if (!more) return more.error();
    }
  }
  if (Result<void> finished = outputs.value().finish({.interrupted = interrupted()}); !finished)
    return finished.error();
  if (!command.quiet) std::fputs(summary_text(outputs.value().summary()).c_str(), stderr);
  const bool confirmed = check.identical() && !check.compared_nothing();
  if (!command.quiet || !confirmed) std::fprintf(stderr, "lsv: replay: %s\n", check.text().c_str());
  if (interrupted()) return kExitInterrupted;
  return confirmed ? kExitOk : kExitLowQuality;
}

}  // namespace

void add_replay_command(CLI::App& app, int& exit_code) {
  auto command = std::make_shared<ReplayCommand>();
  CLI::App* const sub = app.add_subcommand(
      "replay", "Measure a recording again with its own settings, and check that it says the same");
  sub->add_option("RECORDING", command->recording, "A recording of lsv (.mcap)")->required();
  add_output_options(*sub, command->outputs);
  sub->add_flag("-q,--quiet", command->quiet, "No progress and no summary on stderr");
  sub->footer(
      "Example:\n"
      "  lsv replay drive.mcap -o out\n"
      "Exit codes: 0 every step that can be compared is bit for bit as recorded, 1 output not "
      "written, 2 usage, 3 input, 4 a step is not as recorded or none can be compared, 130 "
      "interrupted.");
  sub->callback([command, sub, &exit_code] {
    if (const Result<void> named = refuse_empty_names(*sub); !named) {
      exit_code = report_error(named.error());
      return;
    }
    const Result<int> replayed = replay(*command);
    exit_code = replayed ? replayed.value() : report_error(replayed.error());
  });
}

}  // namespace lsv::cli
