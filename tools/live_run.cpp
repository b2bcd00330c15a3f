// SPDX-License-Identifier: BSD-3-Clause
#include "tools/live_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "calibration/calibration_io.h"
#include "calibration/sensor_maps_io.h"
#include "calibration/text_file.h"
#include "lsv/camera/open_camera.h"
#include "lsv/mcap/bytes.h"
#include "lsv/mcap/tail.h"
#include "lsv/odometer.h"
#include "lsv/output/number_text.h"
#include "lsv/record/recorder.h"
#include "lsv/sensor_setup.h"
#include "lsv/stream/reopening_source.h"
#include "lsv/stream/stream.h"
#include "tools/commands.h"
#include "tools/health_json.h"
#include "tools/interrupt.h"
#include "tools/live_dashboard.h"
#include "tools/live_events.h"
#include "tools/output_names.h"
#include "tools/track_outputs.h"

namespace lsv::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// How often an interrupt and the clock are looked at while no frame comes.
constexpr std::int64_t kLook_ns = 20'000'000;
/// Reports that wait while a disk is slow: those of so many seconds.
constexpr double kReportsAhead_s = 10.0;

/// What the maps of a calibration are cut from: the whole sensor, where a region of it is sent.
FrameFormat whole_frames(const LiveSettings& live, const FrameFormat& sent) {
  const auto& sensor = live.track.config.calibration.format;
  if (!live.camera.region || !sensor) return sent;
  FrameFormat whole = sent;
  whole.width_px = sensor->width_px;
  whole.height_px = sensor->height_px;
  return whole;
}

Result<void> calibrate(LiveSettings& live, const FrameFormat& sent) {
  TrackSettings& track = live.track;
  Result<Calibration> calibration = load_calibration(track.calibration_path);
  if (!calibration) return calibration.error();
  track.config.calibration = std::move(calibration).value();
  const FrameFormat whole = whole_frames(live, sent);
  const std::optional<Roi> region = whole == sent ? std::optional<Roi>{} : live.camera.region;
  return set_sensor_maps(track.config, track.calibration_path, whole, region);
}

Result<RunInfo> run_info(const TrackConfig& config, const LiveSourceInfo& source) {
  // Only the range of lags is wanted; the one that measures belongs to the stream.
  const Result<Odometer> odometer = Odometer::create(config, source.format);
  if (!odometer) return odometer.error();
  RunInfo info;
  info.version = LSV_VERSION;
  info.source_description = source.description;
  info.format = source.format;
  info.time_base = formatted("camera, %.10g Hz", 1e9 / static_cast<double>(source.period_ns));
  info.config = config;
  info.max_shift = odometer.value().lags();
  return info;
}

std::vector<std::string> inputs_of(const LiveCommand& command) {
  const TrackSettings& track = command.live.track;
  std::vector<std::string> out = {track.calibration_path};
  for (const std::string& path :
       {command.config_path, sensor_maps_path(track.config.calibration, track.calibration_path)}) {
    if (!path.empty()) out.push_back(path);
  }
  return out;
}

/// What is written besides OutputPaths. The tail is there while the recording is written.
std::vector<std::string> other_outputs_of(const LiveCommand& command) {
  std::vector<std::string> out = {command.health_path};
  if (!command.recording.empty()) {
    out.push_back(command.recording);
    out.push_back(mcap::tail_path(command.recording));
  }
  return out;
}

int reports_ahead(std::int64_t period_ns) {
  const double reports = kReportsAhead_s * 1e9 / static_cast<double>(period_ns);
  return static_cast<int>(std::clamp(reports, 1000.0, 1e6));
}

/// Everything that comes out of a running stream, to where it belongs. Outputs are written on this
/// thread, so that a slow disk holds up nothing but them.
class Run {
 public:
  Run(Stream& stream, LiveEvents& events, TrackOutputs& outputs, bool quiet)
      : stream_(stream), events_(events), outputs_(outputs), dashboard_(quiet) {}

  /// Until `seconds` are over (0: never), someone interrupts, or no frame will come any more.
  Result<void> until(double seconds) {
    const Clock::time_point start = Clock::now();
    const auto is_over = [&] {
      return seconds > 0.0 &&
             std::chrono::duration<double>(Clock::now() - start).count() >= seconds;
    };
    while (!interrupted() && !is_over()) {
      const std::optional<StreamReport> report = stream_.next(kLook_ns);
      if (report) {
        if (Result<void> written = take(*report); !written) return written;
      }
      tell_events();
      if (dashboard_.is_due()) dashboard_.draw(stream_.health());
      if (!report && stream_.finished()) break;
    }
    return {};
  }

  /// Stops the camera and takes what was measured until then.
  Result<void> finish() {
    stream_.stop();
    while (const std::optional<StreamReport> report = stream_.next(0)) {
      if (Result<void> written = take(*report); !written) return written;
    }
    tell_events();
    return {};
  }

  /// Why the camera was given up, if it was.
  const std::string& failure() const { return failure_; }

 private:
  Result<void> take(const StreamReport& report) {
    dashboard_.measured(report.step);
    return outputs_.write(report.step);
  }

  void tell_events() {
    for (const StreamEvent& event : events_.take()) {
      if (event.name == "source_failed") failure_ = event.text;
      dashboard_.tell(event);
    }
  }

  Stream& stream_;
  LiveEvents& events_;
  TrackOutputs& outputs_;
  LiveDashboard dashboard_;
  std::string failure_;
};

Result<void> check(const LiveCommand& command) {
  const auto usage = [](const char* text) { return Error{ErrorCode::invalid_argument, text}; };
  if (!(command.live.track.max_rejected_share >= 0.0 &&
        command.live.track.max_rejected_share <= 1.0))
    return usage("--max-rejected must be between 0 and 1");
  if (!(command.seconds >= 0.0 && command.seconds <= 1e9))
    return usage("--seconds must be between 0 and 1e9");
  if (command.outputs.report_frame)
    return usage("--report-frame needs recorded frames; a live report shows no correlation plane");
  if (command.live.track.calibration_path.empty()) {
    return usage(
        "a calibration is needed to turn pixels into metres: give --calibration FILE "
        "(sample_frames/calibration.toml is an example)");
  }
  if (Result<void> file = refuse_stdout(command.recording, "a recording"); !file) return file;
  return check_output_names(command.outputs, other_outputs_of(command), inputs_of(command));
}

Result<std::unique_ptr<LiveSource>> open_source(const LiveCommand& command) {
  return ReopeningSource::open(
      [source = command.source, camera = command.live.camera] {
        return open_camera(source, camera);
      },
      command.live.reopening);
}

/// Null when nothing is to be recorded.
Result<std::unique_ptr<Recorder>> start_recording(const LiveCommand& command,
                                                  const LiveSourceInfo& camera,
                                                  LiveEvents& events) {
  if (command.recording.empty()) return std::unique_ptr<Recorder>{};
  const TrackSettings& track = command.live.track;
  Result<std::string> calibration = read_text_file(track.calibration_path, "calibration");
  if (!calibration) return calibration.error();
  RecorderOptions options{.path = command.recording, .format = camera.format};
  options.program = "lsv " LSV_VERSION;
  options.source = camera.description;
  options.config_toml = command.settings.to_toml();
  options.calibration_toml = std::move(calibration).value();
  if (track.config.sensor_maps) {
    const Result<std::string> maps = sensor_maps_tiff(*track.config.sensor_maps);
    if (!maps) return maps.error();
    const mcap::ByteView bytes = mcap::bytes_of(maps.value());
    options.sensor_maps_tiff.assign(bytes.begin(), bytes.end());
  }
  if (command.compress) options.compression = mcap::Compression::zstd;
  options.alarm = [&events](const StreamEvent& event) { events.on_event(event); };
  return Recorder::create(options);
}

/// Tells every one of them, and that of the first is the exit code.
int report_errors(const std::vector<Error>& errors) {
  const int exit_code = report_error(errors.front());
  for (std::size_t i = 1; i < errors.size(); ++i) report_error(errors[i]);
  return exit_code;
}

Result<int> live(LiveCommand& command) {
  if (Result<void> resolved = resolve_live(command.live); !resolved) return resolved.error();
  if (Result<void> checked = check(command); !checked) return checked.error();
  Result<std::unique_ptr<LiveSource>> source = open_source(command);
  if (!source) return source.error();
  const LiveSourceInfo camera = source.value()->info();
  if (Result<void> calibrated = calibrate(command.live, camera.format); !calibrated)
    return calibrated.error();
  const TrackConfig& config = command.live.track.config;
  const Result<RunInfo> info = run_info(config, camera);
  if (!info) return info.error();
  // Once more, with the sensor maps that the calibration names.
  Result<TrackOutputs> outputs =
      TrackOutputs::open(command.outputs, info.value(), command.settings.to_toml(),
                         inputs_of(command), other_outputs_of(command));
  if (!outputs) return outputs.error();

  LiveEvents events;
  Result<std::unique_ptr<Recorder>> recorder = start_recording(command, camera, events);
  if (!recorder) return recorder.error();
  std::vector<StreamSink*> sinks = {&events};
  if (recorder.value()) sinks.push_back(recorder.value().get());
  StreamOptions options = command.live.stream;
  options.queue_reports = reports_ahead(camera.period_ns);
  Result<std::unique_ptr<Stream>> stream =
      Stream::start(std::move(source).value(), config, options, std::move(sinks));
  if (!stream) return stream.error();
  if (!command.quiet)
    std::fprintf(stderr, "lsv: %s, %d x %d px, %.6g Hz\n", camera.description.c_str(),
                 camera.format.width_px, camera.format.height_px,
                 1e9 / static_cast<double>(camera.period_ns));
  std::string failure;
  {
    Run run(*stream.value(), events, outputs.value(), command.quiet);
    if (Result<void> done = run.until(command.seconds); !done) return done.error();
    if (Result<void> done = run.finish(); !done) return done.error();
    failure = run.failure();
  }
  // A full disk that has spoiled the recording, say, must not cost the other results as well.
  std::vector<Error> errors;
  const auto keep = [&errors](const Result<void>& done) {
    if (!done) errors.push_back(done.error());
  };
  if (recorder.value()) keep(recorder.value()->close());
  keep(outputs.value().finish({.interrupted = interrupted()}));
  const HealthSnapshot health = stream.value()->health();
  if (!command.health_path.empty()) keep(write_file(command.health_path, health_json(health)));
  const Summary summary = outputs.value().summary();
  if (!command.quiet) {
    std::fputs(summary_text(summary).c_str(), stderr);
    for (const std::string& line : {latency_line(health), losses_line(health)})
      std::fprintf(stderr, "%s\n", line.c_str());
  }
  if (!failure.empty()) errors.push_back({ErrorCode::bad_input, failure});
  if (!errors.empty()) return report_errors(errors);
  return exit_code_of(summary, command.live.track.max_rejected_share);
}

}  // namespace

void add_live_options(CLI::App& sub, LiveCommand& command) {
  sub.add_option("SOURCE", command.source, kCameraHelp)->required();
  sub.add_option("--seconds", command.seconds, "How long; 0: until it is interrupted")
      ->capture_default_str();
  add_output_options(sub, command.outputs);
  sub.add_option("--health", command.health_path,
                 "File of the final counters, losses and latencies, as JSON")
      ->group("Outputs ('-' is standard output)");
  sub.add_flag("--zstd", command.compress, "Compress the recording");
  sub.add_option("--config", command.config_path, "Settings from a TOML file");
  sub.add_flag("--print-config", command.print_config,
               "Print every setting with its source and stop");
  sub.add_flag("-q,--quiet", command.quiet, "No dashboard and no summary on stderr");
  add_live_settings(sub, command.settings, command.live);
}

int run_live(LiveCommand& command) {
  if (Result<void> resolved = command.settings.resolve(command.config_path,
                                                       Settings::Variables::some_of_other_commands);
      !resolved)
    return report_error(resolved.error());
  if (command.print_config) {
    std::fputs(command.settings.to_toml().c_str(), stdout);
    return std::fflush(stdout) == 0 ? kExitOk : kExitOutputFailed;
  }
  silence_camera_libraries();
  catch_interrupts();
  const Result<int> done = live(command);
  return done ? done.value() : report_error(done.error());
}

}  // namespace lsv::cli
