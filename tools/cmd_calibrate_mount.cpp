// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate mount`: where sensors sit on a vehicle, and how their scales compare.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/calibration_io.h"
#include "calibration/sensor_maps_io.h"
#include "lsv/ingest/option_text.h"
#include "lsv/output/output_file.h"
#include "tools/body_reference.h"
#include "tools/commands.h"
#include "tools/mount_page.h"
#include "tools/mount_report.h"
#include "tools/output_names.h"
#include "tools/sensor_track.h"

namespace lsv::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    "The reference is the pose of the vehicle over time, on the clock of the tracks, in a frame\n"
    "fixed to the ground with z up: CSV with time_s,x_m,y_m,yaw_rad and optionally\n"
    "sigma_m,sigma_yaw_rad, or a .tum file. A track is what `lsv track --csv` wrote. Give --track\n"
    "and --calibration once per sensor, in the same order. Drive straight stretches and curves to\n"
    "both sides. Writes DIR/<name of the calibration> with [mount] filled for each sensor,\n"
    "mount.json and report.html. Frames, signs and model: docs/mount.md.\n"
    "\n"
    "Example, without hardware:\n"
    "  lsv simulate tracks -o drive\n"
    "  lsv calibrate mount --reference drive/body.csv \\\n"
    "      --track drive/front.csv --calibration drive/front.toml \\\n"
    "      --track drive/rear.csv --calibration drive/rear.toml -o out\n"
    "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input.";

// A clock that is not known better than that is not known.
constexpr double kWorstClock_s = 0.02;

struct MountCommand {
  std::string reference;
  std::vector<std::string> tracks;
  std::vector<std::string> calibrations;
  std::vector<std::string> levers;
  std::string output;
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
  double lever_sigma_m = 0.0;
  bool fit_scale = false;
  bool fit_clock = false;
  bool correct_ratio = false;
};

Error usage(std::string sentence) { return {ErrorCode::invalid_argument, std::move(sentence)}; }

/// "X,Y" in m.
Result<KnownLever> lever_from(const std::string& text, double sigma_m) {
  constexpr double kFarthest_m = 100.0;
  const auto parts = split_at(text, ',');
  KnownLever out{.sigma_m = sigma_m};
  if (parts.size() == 2) {
    out.x_m = whole_number<double>(parts[0]).value_or(kUnknown);
    out.y_m = whole_number<double>(parts[1]).value_or(kUnknown);
  }
  if (!(std::abs(out.x_m) <= kFarthest_m && std::abs(out.y_m) <= kFarthest_m))
    return usage("--lever is \"" + text + "\" but must be X,Y in m, such as 0.30,-0.12");
  return out;
}

/// Everything that was asked for, checked.
struct MountTask {
  MountCommand command;
  ReferenceSigmas sigmas;
  std::vector<KnownLever> levers;    // one per sensor, or none
  std::vector<std::string> outputs;  // calibrations, one per sensor

  std::string beside(const char* name) const { return (fs::path(command.output) / name).string(); }
};

Result<void> name_outputs(MountTask& task) {
  for (const std::string& calibration : task.command.calibrations) {
    const std::string output = task.beside(fs::path(calibration).filename().c_str());
    if (std::ranges::find(task.outputs, output) != task.outputs.end())
      return usage("two calibrations are named " + fs::path(calibration).filename().string() +
                   ": give each sensor a file of its own name");
    task.outputs.push_back(output);
  }
  std::vector<std::string> outputs = task.outputs;
  outputs.push_back(task.beside("mount.json"));
  outputs.push_back(task.beside("report.html"));
  for (std::size_t i = 0; i < task.outputs.size(); ++i) {
    if (task.outputs[i] == outputs[outputs.size() - 2] || task.outputs[i] == outputs.back())
      return usage(task.outputs[i] + ": is the name of another output; rename the calibration");
  }
  std::vector<std::string> inputs = task.command.tracks;
  inputs.insert(inputs.end(), task.command.calibrations.begin(), task.command.calibrations.end());
  inputs.push_back(task.command.reference);
  return refuse_inputs(outputs, inputs);
}

Result<MountTask> task_of(const CLI::App& app, const MountCommand& command) {
  MountTask out{.command = command, .sigmas = {}, .levers = {}, .outputs = {}};
  if (command.tracks.size() != command.calibrations.size())
    return usage("give one --calibration for each --track, in the same order");
  if (!command.levers.empty() && command.levers.size() != command.tracks.size())
    return usage("give --lever for each --track, in the same order, or not at all");
  constexpr double kLargestSigma = 10.0;
  const struct {
    const char* name;
    double value;
    std::optional<double>* target;
  } sigmas[] = {{"--sigma-reference-m", command.sigma_m, &out.sigmas.sigma_m},
                {"--sigma-reference-rad", command.sigma_rad, &out.sigmas.sigma_yaw_rad}};
  for (const auto& [name, value, target] : sigmas) {
    if (app.count(name) == 0) continue;
    if (!(value > 0.0 && value <= kLargestSigma))
      return usage(std::string(name) + " must be above 0 and at most 10");
    *target = value;
  }
  const bool has_lever_sigma = app.count("--lever-sigma-m") > 0;
  if (has_lever_sigma == command.levers.empty())
    return usage("--lever and --lever-sigma-m go together");
  if (has_lever_sigma && !(command.lever_sigma_m > 0.0 && command.lever_sigma_m <= kLargestSigma))
    return usage("--lever-sigma-m must be above 0 and at most 10");
  for (const std::string& text : command.levers) {
    const Result<KnownLever> lever = lever_from(text, command.lever_sigma_m);
    if (!lever) return lever.error();
    out.levers.push_back(lever.value());
  }
  if (command.correct_ratio && command.tracks.size() < 2)
    return usage("--correct-ratio needs two sensors");
  if (Result<void> named = name_outputs(out); !named) return named.error();
  return out;
}

/// A sensor with its track under `calibration`.
struct Input {
  Calibration calibration;
  TrackFile track;
  MountOptions options;
};

Result<Input> read_input(const MountTask& task, std::size_t i, const Calibration& calibration) {
  Result<TrackFile> track = read_sensor_track(task.command.tracks[i], calibration);
  if (!track) return track.error();
  Input out{.calibration = calibration, .track = std::move(track).value(), .options = {}};
  if (!task.levers.empty()) out.options.lever = task.levers[i];
  if (task.command.fit_scale) {
    out.options.scale_sigma_ratio = std::numeric_limits<double>::infinity();
  } else if (calibration.scale) {
    out.options.scale_sigma_ratio =
        std::max(std::sqrt(calibration.scale->cov[0][0]) / calibration.sc_x_ratio,
                 std::sqrt(calibration.scale->cov[1][1]) / calibration.sc_y_ratio);
  }
  out.options.fit_clock = task.command.fit_clock;
  return out;
}

/// With both unknown: a wrong scale would look like a wrong clock, and the other way round.
DriveCheck check_of(const BodyReference& reference, const Input& input) {
  MountOptions options = input.options;
  options.scale_sigma_ratio = std::numeric_limits<double>::infinity();
  DriveCheck out;
  for (const bool with_clock : {true, false}) {
    options.fit_clock = with_clock;
    const Result<MountFit> fit = fit_mount(reference, input.track.steps, options);
    if (!fit) continue;
    const double sigma_clock_s = std::sqrt(fit.value().cov[4][4]);
    if (with_clock && !(sigma_clock_s < kWorstClock_s)) continue;
    out.scale_ratio = fit.value().scale_ratio;
    out.sigma_scale_ratio = std::sqrt(fit.value().cov[3][3]);
    if (!with_clock) break;
    out.clock_offset_s = fit.value().clock_offset_s;
    out.sigma_clock_offset_s = sigma_clock_s;
    break;
  }
  return out;
}

Result<MountedSensor> measure(const MountTask& task, std::size_t i, const BodyReference& reference,
                              const Input& input) {
  const auto blame = [&](const Error& error) {
    return Error{error.code, task.command.tracks[i] + ": " + error.message};
  };
  Result<MountFit> fit = fit_mount(reference, input.track.steps, input.options);
  if (!fit) return blame(fit.error());
  MountedSensor out;
  out.track_file = task.command.tracks[i];
  out.track_sha256 = input.track.sha256;
  out.calibration_file = task.command.calibrations[i];
  out.output_file = task.outputs[i];
  out.calibration = input.calibration;
  out.calibration.mount = mount_of(fit.value());
  out.refused = input.track.refused;
  out.accepted = input.track.steps.size();
  out.fits_scale = input.options.scale_sigma_ratio > 0.0;
  out.fits_clock = input.options.fit_clock;
  out.stretches = leave_out_stretches(reference, input.track.steps, input.options, fit.value());
  out.check = check_of(reference, input);
  out.mirrored = mirrored_mount(reference, input.track.steps, input.options, fit.value());
  out.fit = std::move(fit).value();
  return out;
}

/// With the clock as the drive has it, asked for or not: the headings must be those of the time.
PairSensor pair_sensor(const Input& input, const MountedSensor& sensor) {
  const double checked_s = sensor.check.clock_offset_s;
  const bool uses_fit = sensor.fits_clock || !std::isfinite(checked_s);
  return {.track = input.track.steps,
          .clock_offset_s = uses_fit ? sensor.fit.clock_offset_s : checked_s,
          .mount = *sensor.calibration.mount};
}

Result<std::vector<MountPair>> compare(const MountTask& task, const BodyReference& reference,
                                       const std::vector<Input>& inputs,
                                       const std::vector<MountedSensor>& sensors) {
  const Baseline baseline = task.levers.empty() ? Baseline::from_motion : Baseline::from_mounts;
  std::vector<MountPair> out;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (std::size_t j = i + 1; j < inputs.size(); ++j) {
      const Result<ScaleRatio> ratio =
          fit_scale_ratio(reference, pair_sensor(inputs[i], sensors[i]),
                          pair_sensor(inputs[j], sensors[j]), baseline);
      if (!ratio) {
        return Error{ratio.error().code, task.command.tracks[i] + " and " + task.command.tracks[j] +
                                             ": " + ratio.error().message};
      }
      out.push_back(
          {.first = i,
           .second = j,
           .ratio = ratio.value(),
           .false_yaw_rad_per_m = false_yaw_rad_per_m(
               ratio.value().ratio, *sensors[i].calibration.mount, *sensors[j].calibration.mount),
           .is_corrected = false});
    }
  }
  return out;
}

Result<MountReport> report_of(const MountTask& task) {
  const Result<ReferenceFile> reference = read_body_reference(task.command.reference, task.sigmas);
  if (!reference) return reference.error();
  const BodyReference& poses = reference.value().poses;
  MountReport out{.reference_file = task.command.reference,
                  .reference_sha256 = reference.value().sha256,
                  .sensors = {},
                  .pairs = {}};
  std::vector<Input> inputs;
  for (std::size_t i = 0; i < task.command.tracks.size(); ++i) {
    const Result<Calibration> calibration = load_calibration(task.command.calibrations[i]);
    if (!calibration) return calibration.error();
    Result<Input> input = read_input(task, i, calibration.value());
    if (!input) return input.error();
    Result<MountedSensor> sensor = measure(task, i, poses, input.value());
    if (!sensor) return sensor.error();
    inputs.push_back(std::move(input).value());
    out.sensors.push_back(std::move(sensor).value());
  }
  Result<std::vector<MountPair>> pairs = compare(task, poses, inputs, out.sensors);
  if (!pairs) return pairs.error();
  out.pairs = std::move(pairs).value();
  if (!task.command.correct_ratio) return out;

  // The first sensor stays; the pairs with it come first.
  for (std::size_t i = 1; i < inputs.size(); ++i) {
    MountPair& pair = out.pairs[i - 1];
    const Calibration corrected = with_reading_divided(inputs[i].calibration, pair.ratio.ratio);
    const Result<Input> input = read_input(task, i, corrected);
    if (!input) return input.error();
    Result<MountedSensor> sensor = measure(task, i, poses, input.value());
    if (!sensor) return sensor.error();
    out.sensors[i] = std::move(sensor).value();
  }
  for (MountPair& pair : out.pairs) pair.is_corrected = true;
  return out;
}

Result<void> write_outputs(const MountTask& task, const MountReport& report) {
  std::error_code status;
  fs::create_directories(task.command.output, status);
  if (status) {
    return Error{ErrorCode::output_failed,
                 task.command.output + ": cannot be created: " + status.message()};
  }
  if (Result<void> done = write_file(task.beside("report.html"), mount_html(report)); !done)
    return done;
  if (Result<void> done = write_file(task.beside("mount.json"), mount_json(report)); !done)
    return done;
  for (const MountedSensor& sensor : report.sensors) {
    const std::string text = calibration_text(
        with_maps_seen_from(task.command.output, sensor.calibration, sensor.calibration_file));
    if (const Result<Calibration> read = parse_calibration(text, sensor.output_file); !read)
      return read.error();
    if (Result<void> done = write_file(sensor.output_file, text); !done) return done;
  }
  return {};
}

int run(const CLI::App& app, const MountCommand& command) {
  const Result<MountTask> task = task_of(app, command);
  if (!task) return report_error(task.error());
  const Result<MountReport> report = report_of(task.value());
  if (!report) return report_error(report.error());
  if (Result<void> written = write_outputs(task.value(), report.value()); !written)
    return report_error(written.error());
  std::fputs(mount_text(report.value()).c_str(), stdout);
  return std::fflush(stdout) == 0 ? kExitOk : kExitOutputFailed;
}

}  // namespace

void add_calibrate_mount(CLI::App& calibrate, int& exit_code) {
  CLI::App* const sub = calibrate.add_subcommand(
      "mount", "Find yaw and lever arm of sensors on a vehicle, and the ratio of their scales");
  const auto command = std::make_shared<MountCommand>();
  MountCommand& c = *command;
  sub->add_option("--reference", c.reference, "Trajectory of the vehicle (CSV or .tum)")
      ->required();
  sub->add_option("--track", c.tracks, "Track of a sensor, CSV of lsv track; once per sensor")
      ->required()
      ->allow_extra_args(false);
  sub->add_option("--calibration", c.calibrations, "Its calibration; once per sensor")
      ->required()
      ->allow_extra_args(false);
  sub->add_option("-o,--output", c.output,
                  "Folder for the calibrations, mount.json and report.html")
      ->required();
  sub->add_option("--sigma-reference-m", c.sigma_m,
                  "Sigma of the reference per axis, m, where it has no column sigma_m");
  sub->add_option("--sigma-reference-rad", c.sigma_rad,
                  "Sigma of its yaw, rad, where it has no column sigma_yaw_rad");
  sub->add_option("--lever", c.levers,
                  "Lever arm X,Y of a sensor, m, measured by other means; once per sensor")
      ->allow_extra_args(false);
  sub->add_option("--lever-sigma-m", c.lever_sigma_m, "Sigma of --lever per axis, m");
  sub->add_flag("--fit-scale", c.fit_scale,
                "Take the scale of each sensor as unknown instead of as calibrated");
  sub->add_flag("--fit-clock", c.fit_clock,
                "Find the offset between the clocks, up to 0.5 s, with the mount");
  sub->add_flag("--correct-ratio", c.correct_ratio,
                "Change the scale of the second and later sensors to agree with the first");
  sub->footer(kFooter);
  sub->callback([sub, command, &exit_code] { exit_code = run(*sub, *command); });
}

}  // namespace lsv::cli
