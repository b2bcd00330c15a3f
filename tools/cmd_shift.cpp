// SPDX-License-Identifier: BSD-3-Clause
// lsv shift: the shift between two images, each pair on its own, as JSON.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lsv/deformation_meter.h"
#include "lsv/fixed_pattern.h"
#include "lsv/ingest/frame_source.h"
#include "lsv/output/number_text.h"
#include "lsv/output/output_file.h"
#include "lsv/shift_meter.h"
#include "tools/calibrated_frames.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/output_names.h"
#include "tools/settings.h"
#include "tools/track_settings.h"

namespace lsv::cli {
namespace {

struct ShiftCommand {
  std::vector<std::string> frames;
  bool pairs = false;
  std::string plane_path;
  std::string output_path = "-";
  TrackSettings track;
  Settings settings;
};

/// Without a calibration nothing is known of the camera: no pixel scale, no noise.
Calibration unknown_camera() {
  Calibration out;
  out.sensor_name = "unknown";
  out.pixel_pitch_x_m = out.pixel_pitch_y_m = 1.0;
  out.sc_x_ratio = out.sc_y_ratio = 1.0;
  out.noise_mean_counts = out.noise_sd_counts = 0.0;
  return out;
}

/// What one pair needs; made for the first pair and kept.
struct PairMeter {
  ShiftMeter meter;
  FixedPattern fixed_pattern;
  std::optional<DeformationMeter> deformation_meter;
  TrackFrame earlier;
  TrackFrame later;
  TrackReference reference;

  PairMeter(ShiftMeter m, FixedPattern f, std::optional<DeformationMeter> d)
      : meter(std::move(m)),
        fixed_pattern(std::move(f)),
        deformation_meter(std::move(d)),
        earlier(meter.make_frame()),
        later(meter.make_frame()),
        reference(meter.make_reference()) {}

  TrackedShift measure(const FrameView& a, const FrameView& b) {
    earlier.load(fixed_pattern.corrected(a));
    later.load(fixed_pattern.corrected(b));
    for (const TrackFrame* frame : {&earlier, &later}) {
      if (const ShiftStatus fitness = meter.fitness(*frame); fitness != ShiftStatus::ok)
        return refused(fitness);
    }
    if (meter.frozen(earlier, later)) return refused(ShiftStatus::frozen);
    meter.build(earlier, reference);
    return meter.refine(earlier, reference, later, meter.acquire(earlier, later));
  }

  /// Of the pair measured last.
  Deformation deformation(const Shift& shift) {
    if (!deformation_meter || shift.status != ShiftStatus::ok) return {};
    return deformation_meter->measure(earlier, later, shift.dx_px, shift.dy_px);
  }

 private:
  static TrackedShift refused(ShiftStatus status) {
    TrackedShift out;
    out.shift.status = status;
    return out;
  }
};

Result<PairMeter> make_meter(const TrackConfig& config, const FrameFormat& format) {
  Result<ShiftMeter> meter = ShiftMeter::create(config, format);
  if (!meter) return meter.error();
  Result<FixedPattern> fixed_pattern = FixedPattern::create(config, format, false);
  if (!fixed_pattern) return fixed_pattern.error();
  std::optional<DeformationMeter> deformation;
  if (config.measure_deformation) {
    Result<DeformationMeter> made =
        DeformationMeter::create(format, config.calibration.noise_sd_counts);
    if (!made) return made.error();
    deformation.emplace(std::move(made).value());
  }
  return PairMeter(std::move(meter).value(), std::move(fixed_pattern).value(),
                   std::move(deformation));
}

nlohmann::ordered_json json_of(const Frame& a, const Frame& b, const TrackedShift& found,
                               const Deformation& deformation, const TrackConfig& config) {
  const Shift& shift = found.shift;
  const bool ok = shift.status == ShiftStatus::ok;
  // A non-finite number becomes null.
  const auto if_ok = [ok](double value) { return ok ? value : kUnknown; };
  nlohmann::ordered_json row = {
      {"schema", "lsv.shift/1"},
      {"frame_a", a.index},
      {"frame_b", b.index},
      {"status", word(shift.status)},
      {"dx_px", if_ok(shift.dx_px)},
      {"dy_px", if_ok(shift.dy_px)},
      {"sigma_dx_px", if_ok(std::sqrt(shift.cov.xx_px2))},
      {"sigma_dy_px", if_ok(std::sqrt(shift.cov.yy_px2))},
      {"cov_px2", {if_ok(shift.cov.xx_px2), if_ok(shift.cov.xy_px2), if_ok(shift.cov.yy_px2)}},
      {"zncc", shift.quality.zncc},
      {"q", shift.quality.q},
      {"peak_ratio", shift.quality.peak_ratio},
      {"peak_to_rms", shift.quality.peak_to_rms},
      {"zncc_sigmas", shift.quality.zncc_sigmas},
      {"outlier_probability", shift.quality.outlier_probability},
      {"preset", word(config.preset)},
      {"engine", word(config.correlation.engine)},
      {"peak_fit", word(config.correlation.peak_fit)},
      {"refined", ok && found.refined}};
  if (config.measure_deformation) {
    row["rotation_rad"] = deformation.rotation_rad;
    row["sigma_rotation_rad"] = deformation.sigma_rotation_rad;
    row["expansion_ratio"] = deformation.expansion_ratio;
    row["sigma_expansion_ratio"] = deformation.sigma_expansion_ratio;
  }
  return row;
}

/// One row per dy, one column per dx, both named in px.
Result<void> write_plane(const std::string& path, const CorrelationPlane& plane) {
  Result<OutputFile> file = OutputFile::open(path);
  if (!file) return file.error();
  std::string text = "# correlation plane: rows dy_px, columns dx_px\ndy_px";
  for (int dx = -plane.lags.max_dx_px; dx <= plane.lags.max_dx_px; ++dx) {
    text += ',';
    append_integer(text, dx);
  }
  for (int dy = -plane.lags.max_dy_px; dy <= plane.lags.max_dy_px; ++dy) {
    text += '\n';
    append_integer(text, dy);
    for (int dx = -plane.lags.max_dx_px; dx <= plane.lags.max_dx_px; ++dx) {
      text += ',';
      append_fixed(text, plane.at(dx, dy), 7);
    }
  }
  text += '\n';
  if (Result<void> written = file.value().write(text); !written) return written;
  return file.value().commit();
}

/// True when a pair was read, false at the end of the input. Where the pairs before it began at
/// `first_index`, this one begins an even number of steps further on.
Result<bool> next_pair(FrameSource& source, std::optional<std::int64_t> first_index,
                       std::int64_t step, Frame& a, Frame& b) {
  Result<bool> first = source.next(a);
  if (!first || !first.value()) return first;
  Result<bool> second = source.next(b);
  if (!second) return second;
  const std::string frame = "frame " + std::to_string(a.index);
  if (!second.value()) {
    return Error{ErrorCode::bad_input,
                 frame + " has no partner: pairs need an even number of frames"};
  }
  const bool begins_well = !first_index || (a.index - *first_index) % (2 * step) == 0;
  if (!begins_well || b.index != a.index + step) {
    return Error{ErrorCode::bad_input,
                 frame + " and frame " + std::to_string(b.index) +
                     " are no pair: a frame is missing; with --ignore-numbers the frames are "
                     "taken two by two whatever their numbers"};
  }
  return second;
}

struct Counts {
  int pairs = 0;
  int refused = 0;
  ShiftStatus last_reason = ShiftStatus::ok;
};

Result<Counts> measure_pairs(ShiftCommand& command, FrameSource& source, OutputFile& out) {
  Result<PairMeter> made = make_meter(command.track.config, source.info().format);
  if (!made) return Error{made.error().code, command.frames.front() + ": " + made.error().message};
  PairMeter& meter = made.value();
  Counts counts;
  Frame a, b;
  std::optional<std::int64_t> first_index;
  while (!interrupted()) {
    const Result<bool> more =
        next_pair(source, first_index, std::max<std::int64_t>(command.track.source.step, 1), a, b);
    if (!more && interrupted()) break;  // the signal ended the wait for a pipe
    if (!more)
      return Error{more.error().code, command.frames.front() + ": " + more.error().message};
    if (!more.value()) break;
    if (!first_index) first_index = a.index;
    const TrackedShift found = meter.measure(a.view(), b.view());
    ++counts.pairs;
    if (found.shift.status != ShiftStatus::ok) {
      ++counts.refused;
      counts.last_reason = found.shift.status;
    }
    const nlohmann::ordered_json row =
        json_of(a, b, found, meter.deformation(found.shift), command.track.config);
    if (Result<void> written = out.write(row.dump(command.pairs ? -1 : 2) + '\n'); !written)
      return written.error();
    if (command.pairs || command.plane_path.empty()) continue;
    if (Result<void> written = write_plane(command.plane_path, meter.meter.plane()); !written)
      return written.error();
  }
  return counts;
}

Result<void> check(const ShiftCommand& command) {
  if (!command.pairs && command.frames.size() != 2) {
    return Error{ErrorCode::invalid_argument,
                 "lsv shift takes two images, A and B; for more use --pairs FRAMES"};
  }
  if (command.pairs && command.frames.empty())
    return Error{ErrorCode::invalid_argument, "no frames after --pairs"};
  if (command.pairs && !command.plane_path.empty())
    return Error{ErrorCode::invalid_argument, "--plane is for one pair, not for --pairs"};
  if (!(command.track.max_rejected_share >= 0.0 && command.track.max_rejected_share <= 1.0))
    return Error{ErrorCode::invalid_argument, "--max-rejected must be between 0 and 1"};
  return at_most_one_on_stdout({command.output_path, command.plane_path});
}

Result<int> shift(ShiftCommand& command) {
  if (Result<void> resolved =
          command.settings.resolve("", Settings::Variables::some_of_other_commands);
      !resolved)
    return resolved.error();
  if (Result<void> checked = check(command); !checked) return checked.error();
  TrackSettings& track = command.track;
  track.config.calibration = unknown_camera();
  track.source.need_time = false;
  // A and B are what their places say, whatever their names.
  if (!command.pairs) track.source.ignore_numbers = true;
  Result<std::unique_ptr<FrameSource>> source = open_calibrated_frames(command.frames, track);
  if (!source) return source.error();
  const std::vector<std::string> inputs = inputs_of(source.value()->info(), track);
  if (Result<void> checked = refuse_inputs({command.output_path, command.plane_path}, inputs);
      !checked)
    return checked.error();
  Result<OutputFile> out = OutputFile::open(command.output_path);
  if (!out) return out.error();
  catch_interrupts();
  const Result<Counts> counts = measure_pairs(command, *source.value(), out.value());
  if (!counts) return counts.error();
  if (Result<void> committed = out.value().commit(); !committed) return committed.error();
  if (interrupted()) return kExitInterrupted;
  if (counts.value().pairs == 0)
    return Error{ErrorCode::bad_input, command.frames.front() + ": no frames to pair"};
  const double share =
      static_cast<double>(counts.value().refused) / static_cast<double>(counts.value().pairs);
  if (counts.value().refused < counts.value().pairs && share <= track.max_rejected_share)
    return kExitOk;
  std::fprintf(stderr, "lsv: %d of %d pairs were refused, the last one %s: %s\n",
               counts.value().refused, counts.value().pairs,
               word(counts.value().last_reason).data(), advice(counts.value().last_reason).data());
  return kExitLowQuality;
}

}  // namespace

void add_shift_command(CLI::App& app, int& exit_code) {
  auto command = std::make_shared<ShiftCommand>();
  CLI::App* const sub =
      app.add_subcommand("shift", "Measure the shift between two images, as JSON");
  sub->add_option("FRAMES", command->frames, "Images A and B; with --pairs any frames");
  sub->add_flag("--pairs", command->pairs,
                "Take the frames two by two, each pair on its own: JSON Lines");
  sub->add_option("--plane", command->plane_path, "Write the correlation plane as CSV");
  sub->add_option("-o,--output", command->output_path, "File for the JSON ('-': standard output)")
      ->capture_default_str();
  add_track_settings(*sub, command->settings, command->track);
  sub->footer(
      "Positive dx: the pattern moved to a larger column from A to B. Without --calibration the\n"
      "camera is taken as free of noise.\n"
      "Example:\n"
      "  lsv shift sample_frames/drive_png/frame_00000.png "
      "sample_frames/drive_png/frame_00001.png\n"
      "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input, 4 refused, 130 interrupted.");
  sub->callback([command, &exit_code] {
    const Result<int> measured = shift(*command);
    exit_code = measured ? measured.value() : report_error(measured.error());
  });
}

}  // namespace lsv::cli
