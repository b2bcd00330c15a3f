// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate tracks`: a drive as a reference system and laser speckle sensors on the vehicle
// report it, with the truth beside it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "calibration/calibration_io.h"
#include "lsv/ingest/option_text.h"
#include "lsv/output/csv_sink.h"
#include "lsv/output/number_text.h"
#include "lsv/output/output_file.h"
#include "sim/drive_sensors.h"
#include "tools/commands.h"
#include "tools/part_folder.h"

namespace lsv::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    "Writes body.csv (pose of the vehicle: x forward, y left, yaw counter-clockwise), for each\n"
    "sensor a track NAME.csv as of lsv track and its calibration NAME.toml, and truth.csv (where\n"
    "the sensors sit, and by which factor they read too much). Positive x_m of a track: the "
    "sensor\n"
    "moved over the ground along its x axis. Nothing is overwritten.\n"
    "\n"
    "Drives: figure (straight, curves, back, slalom), slalom, straight, circle.\n"
    "A sensor is NAME,X_M,Y_M,YAW_RAD,READS_RATIO.\n"
    "\n"
    "Example:\n"
    "  lsv simulate tracks -o drive\n"
    "  lsv simulate tracks -o drive2 --drive slalom --refused 0.01 --lost-s 20,23 \\\n"
    "      --sensor left,0,0.15,0,1 --sensor right,0,-0.15,0,1.001\n";

struct TracksOptions {
  std::string output;
  std::string drive = "figure";
  double duration_s = 60.0;
  double speed_m_s = 0.1;
  double yaw_rate_rad_s = 0.5;
  double reference_rate_hz = 50.0;
  double reference_sigma_m = 1e-3;
  double reference_sigma_rad = 1e-3;
  double track_rate_hz = 500.0;
  double sigma_px = 0.005;
  double refused_ratio = 0.0;
  double clock_ahead_s = 0.0;
  std::string lost_s;
  std::vector<std::string> sensors = {"front,0.30,0.15,0.05,1", "rear,-0.25,-0.15,-1.5,1.001"};
  std::uint64_t seed = 1;
};

struct NamedSensor {
  std::string name;
  sim::SensorPlace place;
};

Error usage(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

Result<std::vector<double>> numbers(const char* option, const std::string& text,
                                    std::size_t skipped, std::size_t count, const char* form) {
  const auto parts = split_at(text, ',');
  std::vector<double> out;
  for (std::size_t i = skipped; i < parts.size(); ++i) {
    const auto value = whole_number<double>(parts[i]);
    if (value && std::isfinite(*value)) out.push_back(*value);
  }
  if (parts.size() != skipped + count || out.size() != count)
    return usage(std::string(option) + " is \"" + text + "\" but must be " + form);
  return out;
}

Result<NamedSensor> sensor_from(const std::string& text) {
  const auto values = numbers("--sensor", text, 1, 4,
                              "NAME,X_M,Y_M,YAW_RAD,READS_RATIO, such as "
                              "front,0.30,0.15,0.05,1");
  if (!values) return values.error();
  const std::string name(split_at(text, ',')[0]);
  constexpr std::string_view kLetters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  if (name.empty() || name.find_first_not_of(kLetters) != std::string::npos || name == "body" ||
      name == "truth")
    return usage("--sensor: the name \"" + name +
                 "\" must be letters, digits, _ or -, and not body or truth");
  const std::vector<double>& v = values.value();
  constexpr double kFarthest_m = 100.0;
  if (!(std::abs(v[0]) <= kFarthest_m && std::abs(v[1]) <= kFarthest_m && std::abs(v[2]) <= 7.0 &&
        v[3] >= 0.5 && v[3] <= 2.0))
    return usage(
        "--sensor " + name +
        ": must sit within 100 m, turn by at most 7 rad and read 0.5 to 2 times the truth");
  return NamedSensor{.name = name,
                     .place = {.x_m = v[0], .y_m = v[1], .yaw_rad = v[2], .reads_ratio = v[3]}};
}

Result<std::vector<NamedSensor>> sensors_of(const TracksOptions& options) {
  std::vector<NamedSensor> out;
  for (const std::string& text : options.sensors) {
    Result<NamedSensor> sensor = sensor_from(text);
    if (!sensor) return sensor.error();
    for (const NamedSensor& other : out) {
      if (other.name == sensor.value().name) return usage("--sensor: two are named " + other.name);
    }
    out.push_back(std::move(sensor).value());
  }
  return out;
}

Result<void> check_ranges(const TracksOptions& o) {
  const struct {
    const char* name;
    double value;
    double least;
    double most;
  } numbers[] = {{"--duration-s", o.duration_s, 5.0, 3600.0},
                 {"--speed-m-s", o.speed_m_s, 1e-3, 100.0},
                 {"--yaw-rate-rad-s", o.yaw_rate_rad_s, 1e-3, 10.0},
                 {"--reference-rate-hz", o.reference_rate_hz, 0.1, 1e4},
                 {"--reference-sigma-m", o.reference_sigma_m, 1e-9, 10.0},
                 {"--reference-sigma-rad", o.reference_sigma_rad, 1e-9, 10.0},
                 {"--track-rate-hz", o.track_rate_hz, 1.0, 1e4},
                 {"--sigma-px", o.sigma_px, 0.0, 100.0},
                 {"--refused", o.refused_ratio, 0.0, 1.0},
                 {"--clock-ahead-s", o.clock_ahead_s, -1e3, 1e3}};
  for (const auto& [name, value, least, most] : numbers) {
    if (!(value >= least && value <= most))
      return usage(formatted("%s is %g but must be between %g and %g", name, value, least, most));
  }
  constexpr double kMostRows = 1e7;
  if (o.duration_s * std::max(o.track_rate_hz, o.reference_rate_hz) > kMostRows)
    return usage("--duration-s times the rates must be at most 1e7 rows");
  return {};
}

Result<sim::BodyDrive> drive_of(const TracksOptions& o) {
  constexpr double kPeriod_s = 6.0;
  if (o.drive == "figure") return sim::figure_drive(o.duration_s, o.speed_m_s, o.yaw_rate_rad_s);
  if (o.drive == "slalom")
    return sim::slalom(o.duration_s, o.speed_m_s, o.yaw_rate_rad_s, kPeriod_s);
  if (o.drive == "straight") return sim::straight(o.duration_s, o.speed_m_s);
  if (o.drive == "circle")
    return sim::circle(o.duration_s, o.speed_m_s, o.speed_m_s / o.yaw_rate_rad_s);
  return usage("--drive is \"" + o.drive + "\" but must be figure, slalom, straight or circle");
}

Calibration calibration_of(const std::string& name) {
  Calibration out;
  out.sensor_name = name + " (simulated)";
  out.pixel_pitch_x_m = out.pixel_pitch_y_m = 14e-6;
  out.sc_x_ratio = 1.985;
  out.sc_y_ratio = 2.000;
  out.noise_mean_counts = 3.0;
  out.noise_sd_counts = 0.5;
  return out;
}

std::string command_line(const CLI::App& command) {
  std::string text = "lsv simulate tracks";
  for (const CLI::Option* option : command.parse_order()) {
    text += " " + option->get_name();
    for (const std::string& value : option->results()) text += " " + value;
  }
  return text;
}

std::string body_csv(const TracksOptions& o, const std::vector<sim::ReferenceReading>& readings,
                     const std::string& command) {
  constexpr int kDecimals = 9;
  std::string text = "# command: " + command +
                     "\n# x_m, y_m: body origin in a frame fixed to the ground; yaw_rad: from "
                     "ground x to body x, counter-clockwise\n"
                     "time_s,x_m,y_m,yaw_rad,sigma_m,sigma_yaw_rad\n";
  for (const sim::ReferenceReading& r : readings) {
    append_seconds(text, r.time_ns);
    for (const double value : {r.x_m, r.y_m, r.yaw_rad}) {
      text += ',';
      append_fixed(text, value, kDecimals);
    }
    for (const double value : {o.reference_sigma_m, o.reference_sigma_rad}) {
      text += ',';
      append_shortest(text, value);
    }
    text += '\n';
  }
  return text;
}

std::string truth_csv(const std::vector<NamedSensor>& sensors) {
  std::string text = "sensor,x_m,y_m,yaw_rad,reads_ratio\n";
  for (const auto& [name, place] : sensors) {
    text += name;
    for (const double value : {place.x_m, place.y_m, place.yaw_rad, place.reads_ratio}) {
      text += ',';
      append_shortest(text, value);
    }
    text += '\n';
  }
  return text;
}

Result<void> write_track(const std::string& path, const TracksOptions& o,
                         const Calibration& calibration,
                         const std::vector<sim::TrackReading>& readings,
                         const std::string& command) {
  Result<OutputFile> file = OutputFile::open(path);
  if (!file) return file.error();
  RunInfo info;
  info.version = LSV_VERSION;
  info.source_description = command;
  info.time_base = formatted("%g Hz", o.track_rate_hz);
  info.config.calibration = calibration;
  CsvSink sink(std::move(file).value(), info);
  const double x_px_per_m = calibration.sc_x_ratio / calibration.pixel_pitch_x_m;
  const double y_px_per_m = calibration.sc_y_ratio / calibration.pixel_pitch_y_m;
  SensorPosition position;
  std::int64_t frame = 0;
  for (const sim::TrackReading& r : readings) {
    StepReport step{.frame = ++frame, .stamp = {r.time_ns}, .dt_ns = r.time_ns - r.since_ns};
    step.shift.status = r.accepted ? ShiftStatus::ok : ShiftStatus::below_zncc_gate;
    if (r.accepted) {
      position.x_m += r.dx_m;
      position.y_m += r.dy_m;
      step.shift.dx_px = x_px_per_m * r.dx_m;
      step.shift.dy_px = y_px_per_m * r.dy_m;
      step.shift.cov = {o.sigma_px * o.sigma_px, 0.0, o.sigma_px * o.sigma_px};
      const double dt_s = 1e-9 * static_cast<double>(step.dt_ns);
      step.velocity.vx_m_s = r.dx_m / dt_s;
      step.velocity.vy_m_s = r.dy_m / dt_s;
      step.velocity.sigma_vx_m_s = o.sigma_px / (x_px_per_m * dt_s);
      step.velocity.sigma_vy_m_s = o.sigma_px / (y_px_per_m * dt_s);
    }
    step.position = position;
    if (Result<void> done = sink.write(step); !done) return done;
  }
  if (Result<void> done = sink.finish({}); !done) return done;
  return sink.commit();
}

Result<void> simulate(const TracksOptions& o, const std::string& command) {
  if (Result<void> sound = check_ranges(o); !sound) return sound;
  const Result<std::vector<NamedSensor>> sensors = sensors_of(o);
  if (!sensors) return sensors.error();
  const Result<sim::BodyDrive> drive = drive_of(o);
  if (!drive) return drive.error();
  std::vector<sim::Interval> lost;
  if (!o.lost_s.empty()) {
    const auto ends = numbers("--lost-s", o.lost_s, 0, 2, "BEGIN,END in s, such as 20,23");
    if (!ends) return ends.error();
    lost.push_back({.begin_s = ends.value()[0], .end_s = ends.value()[1]});
  }
  Result<PartFolder> folder = PartFolder::make(o.output);
  if (!folder) return folder.error();
  const PartFolder& part = folder.value();

  const auto readings = sim::read_reference(drive.value(), {.rate_hz = o.reference_rate_hz,
                                                            .begin_s = 0.0,
                                                            .end_s = o.duration_s,
                                                            .sigma_m = o.reference_sigma_m,
                                                            .sigma_yaw_rad = o.reference_sigma_rad,
                                                            .seed = o.seed});
  if (Result<void> done = write_file(part.file("body.csv"), body_csv(o, readings, command)); !done)
    return done;
  if (Result<void> done = write_file(part.file("truth.csv"), truth_csv(sensors.value())); !done)
    return done;
  std::uint64_t seed = o.seed;
  for (const auto& [name, place] : sensors.value()) {
    const Calibration calibration = calibration_of(name);
    const double m_per_px = calibration.pixel_pitch_x_m / calibration.sc_y_ratio;
    const sim::TrackingConfig tracking{.rate_hz = o.track_rate_hz,
                                       .begin_s = 0.0,
                                       .end_s = o.duration_s,
                                       .clock_ahead_s = o.clock_ahead_s,
                                       .sigma_m = o.sigma_px * m_per_px,
                                       .refused_ratio = o.refused_ratio,
                                       .lost = lost,
                                       .seed = ++seed};
    const std::string text = calibration_text(calibration);
    if (Result<void> done = write_file(part.file(name + ".toml"), text); !done) return done;
    const Result<Calibration> read = parse_calibration(text, name + ".toml");
    if (!read) return read.error();
    if (Result<void> done = write_track(part.file(name + ".csv"), o, read.value(),
                                        sim::read_track(drive.value(), place, tracking), command);
        !done)
      return done;
  }
  return folder.value().commit();
}

void add_options(CLI::App& command, TracksOptions& o) {
  const auto number = [&command](const char* name, double& value, const char* what) {
    command.add_option(name, value, what)->capture_default_str();
  };
  command.add_option("-o,--output", o.output, "Folder to make")->required();
  command.add_option("--drive", o.drive, "figure, slalom, straight or circle")
      ->capture_default_str();
  number("--duration-s", o.duration_s, "Length of the drive");
  number("--speed-m-s", o.speed_m_s, "Speed of the vehicle");
  number("--yaw-rate-rad-s", o.yaw_rate_rad_s, "Largest yaw rate");
  command.add_option("--sensor", o.sensors, "NAME,X_M,Y_M,YAW_RAD,READS_RATIO; once per sensor")
      ->allow_extra_args(false)
      ->capture_default_str();
  number("--reference-rate-hz", o.reference_rate_hz, "Poses per second");
  number("--reference-sigma-m", o.reference_sigma_m, "Noise of the position per axis");
  number("--reference-sigma-rad", o.reference_sigma_rad, "Noise of the yaw");
  number("--track-rate-hz", o.track_rate_hz, "Frames per second");
  number("--sigma-px", o.sigma_px, "Noise of a shift per axis");
  number("--refused", o.refused_ratio, "Share of the frames that are refused one by one, 0 to 1");
  command.add_option("--lost-s", o.lost_s, "BEGIN,END: the ground is lost in this time");
  number("--clock-ahead-s", o.clock_ahead_s, "By which the clocks of the sensors are ahead");
  command.add_option("--seed", o.seed, "Random seed")->capture_default_str();
}

int run(const CLI::App& command, const TracksOptions& options) {
  const Result<void> done = simulate(options, command_line(command));
  return done ? kExitOk : report_error(done.error());
}

}  // namespace

void add_simulate_tracks(CLI::App& simulate, int& exit_code) {
  CLI::App* const tracks = simulate.add_subcommand(
      "tracks", "A drive as a reference and speckle sensors on the vehicle report it");
  tracks->footer(kFooter);
  const auto options = std::make_shared<TracksOptions>();
  add_options(*tracks, *options);
  tracks->callback([tracks, options, &exit_code] { exit_code = run(*tracks, *options); });
}

}  // namespace lsv::cli
