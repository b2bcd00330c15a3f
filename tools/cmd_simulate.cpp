// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate speckle`: simulated frames on disk, with the true motion beside them.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "lsv/output/frame_writer.h"
#include "lsv/output/number_text.h"
#include "lsv/output/output_file.h"
#include "sim/speckle.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/size_option.h"

namespace lsv::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxFrames = 10'000'000;

constexpr const char* kExample =
    "Writes the frames and the true motion (truth.csv: pattern position at mid exposure and shift\n"
    "since the frame before, in px; positive x to larger columns). Nothing is overwritten.\n"
    "\n"
    "Profiles: parked, constant, drive (speed up, stop, reverse), sinusoid, random, or a CSV file\n"
    "with the columns x_px and y_px, one row per frame (a truth.csv will do).\n"
    "\n"
    "Example:\n"
    "  lsv simulate speckle -o run1 --frames 200 --profile drive --speed-px 5 --speed-y-px 1\n"
    "  lsv simulate speckle -o run2/boil.tif --rho 0.95 --profile constant --speed-px 0.25\n";

struct SimulateOptions {
  std::string output;
  std::string truth;
  std::string size = "128x128";
  std::string format;
  std::string profile = "drive";
  std::int64_t frames = 200;
  double speed_px = 3.0;
  double speed_y_px = 0.0;
  double period_frames = 100.0;
  double mean_counts = 0.0;
  double full_well_electrons = 0.0;
  sim::SpeckleConfig camera;
};

Error usage(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

Error disk_error(const fs::path& path, const std::error_code& code) {
  return {ErrorCode::output_failed, "cannot write " + path.string() + ": " + code.message()};
}

bool names_tiff_stack(const std::string& output) {
  const std::string extension = fs::path(output).extension().string();
  return extension == ".tif" || extension == ".tiff";
}

/// The format of the frames in a directory; nothing for a TIFF stack.
Result<std::optional<FrameFileFormat>> file_format(const SimulateOptions& options) {
  if (names_tiff_stack(options.output)) {
    if (options.format.empty() || options.format == "tiff") return std::optional<FrameFileFormat>();
    return usage("--format " + options.format + " does not fit " + options.output +
                 ": name a directory, or leave --format out for a TIFF stack");
  }
  const auto format =
      frame_file_format_from(options.format.empty() ? std::string("png") : options.format);
  if (!format)
    return usage("--format is \"" + options.format + "\" but must be png, tiff, pgm or raw");
  return format;
}

bool in_range(double value, double limit) { return std::abs(value) <= limit; }

Result<sim::MotionProfile> profile_for(const SimulateOptions& o) {
  constexpr double kMaxSpeed_px = 1e4;
  if (!in_range(o.speed_px, kMaxSpeed_px) || !in_range(o.speed_y_px, kMaxSpeed_px))
    return usage("--speed-px and --speed-y-px must be within 10000 px per frame");
  if (!(o.period_frames > 0.0 && o.period_frames <= 1e9))
    return usage("--period-frames must be above 0 and at most 1e9");
  const auto frames = static_cast<double>(o.frames);
  if (o.profile == "parked") return sim::parked();
  if (o.profile == "constant") return sim::constant_velocity(o.speed_px, o.speed_y_px);
  if (o.profile == "drive") return sim::drive(o.speed_px, o.speed_y_px, frames);
  if (o.profile == "sinusoid") return sim::sinusoid(o.speed_px, o.speed_y_px, o.period_frames);
  if (o.profile == "random")
    return sim::random_shifts(o.speed_px, o.speed_y_px, o.frames, o.camera.seed);
  if (fs::path(o.profile).extension() != ".csv") {
    return usage("--profile is \"" + o.profile +
                 "\" but must be parked, constant, drive, sinusoid, random or a .csv file");
  }
  Result<sim::MotionTable> table = sim::read_motion_table(o.profile);
  if (!table) return table.error();
  if (table.value().frames < o.frames) {
    return usage(o.profile + " holds " + std::to_string(table.value().frames) +
                 " positions but --frames asks for " + std::to_string(o.frames));
  }
  return std::move(table.value().profile);
}

/// Refuses to overwrite; an empty directory may be filled.
Result<void> refuse_existing(const fs::path& path, bool may_be_empty_directory) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  if (may_be_empty_directory && fs::is_directory(path, ignored) && fs::is_empty(path, ignored))
    return {};
  return usage(path.string() + " exists already: remove it or choose another name");
}

/// Where frames and truth go until all of them are there: a TIFF stack, or a directory that gets
/// its name at the end. Destroyed without commit(), it leaves nothing behind.
class Recording {
 public:
  static Result<Recording> begin(const SimulateOptions& options,
                                 std::optional<FrameFileFormat> format) {
    Recording recording;
    recording.format_ = format;
    recording.target_ = options.output;
    // "run1/" and "run1" are the same directory.
    if (!recording.target_.has_filename()) recording.target_ = recording.target_.parent_path();
    if (recording.target_.empty())
      return usage("--output names nothing: give a directory or a .tif file");
    if (auto free = refuse_existing(recording.target_, format.has_value()); !free)
      return free.error();
    if (auto made = recording.make_parent(); !made) return made.error();
    auto begun = format ? recording.begin_directory() : recording.begin_stack(options);
    if (!begun) return begun.error();
    if (auto opened = recording.open_truth(options.truth); !opened) return opened.error();
    return recording;
  }

  Recording(Recording&& other) noexcept
      : target_(std::move(other.target_)),
        part_directory_(std::exchange(other.part_directory_, {})),
        format_(other.format_),
        stack_(std::move(other.stack_)),
        truth_(std::move(other.truth_)) {}
  Recording& operator=(Recording&&) = delete;

  ~Recording() {
    truth_.reset();
    std::error_code ignored;
    if (!part_directory_.empty()) fs::remove_all(part_directory_, ignored);
  }

  Result<void> add_truth(std::string_view text) { return truth_->write(text); }

  Result<void> add_frame(const Frame& frame) {
    if (stack_) return stack_->append(frame.view());
    char name[40];
    std::snprintf(name, sizeof name, "frame_%05lld", static_cast<long long>(frame.index));
    return write_frame(frame.view(), *format_,
                       (part_directory_ / name).string() + std::string(extension(*format_)));
  }

  Result<void> commit() {
    if (auto done = truth_->commit(); !done) return done;
    if (stack_) return stack_->commit();
    std::error_code code;
    fs::rename(part_directory_, target_, code);
    if (code) return disk_error(target_, code);
    part_directory_.clear();
    return {};
  }

 private:
  Recording() = default;

  Result<void> make_parent() const {
    if (!target_.has_parent_path()) return {};
    std::error_code code;
    fs::create_directories(target_.parent_path(), code);
    if (code) return disk_error(target_, code);
    return {};
  }

  Result<void> begin_stack(const SimulateOptions& o) {
    const std::int64_t pixel_bytes =
        o.frames * o.camera.width_px * o.camera.height_px * (o.camera.bit_depth > 8 ? 2 : 1);
    auto stack = TiffStackWriter::create(target_.string(), pixel_bytes);
    if (!stack) return stack.error();
    stack_.emplace(std::move(stack).value());
    return {};
  }

  Result<void> begin_directory() {
    const fs::path part = target_.string() + ".part";
    std::error_code code;
    if (fs::create_directory(part, code)) {
      part_directory_ = part;
      return {};
    }
    if (code) return disk_error(target_, code);
    return usage(part.string() + " is left from a run that was cut short: remove it first");
  }

  Result<void> open_truth(const std::string& asked) {
    fs::path path = asked;
    if (asked.empty()) path = (format_ ? part_directory_ : target_.parent_path()) / "truth.csv";
    if (auto free = refuse_existing(path, false); !free) return free;
    if (path == target_) return usage("--truth and --output name the same file");
    auto file = OutputFile::open(path.string());
    if (!file) return file.error();
    truth_.emplace(std::move(file).value());
    return {};
  }

  fs::path target_;
  fs::path part_directory_;  // empty for a stack, and once renamed
  std::optional<FrameFileFormat> format_;
  std::optional<TiffStackWriter> stack_;
  std::optional<OutputFile> truth_;
};

void add_line(std::string& text, std::string_view key, std::string_view value) {
  text += "# ";
  text += key;
  text += ": ";
  for (const char c : value) text += c == '\n' || c == '\r' ? '?' : c;
  text += '\n';
}

void add_line(std::string& text, std::string_view key, double value) {
  std::string number;
  append_shortest(number, value);
  add_line(text, key, number);
}

std::string truth_head(const SimulateOptions& o, const std::string& command) {
  const sim::SpeckleConfig& c = o.camera;
  std::string text;
  add_line(text, "lsv", LSV_VERSION);
  add_line(text, "command", command);
  add_line(text, "units",
           "time s; position and shift px of the pattern on the sensor, at mid "
           "exposure");
  add_line(text, "signs",
           "positive x: the pattern moved to a larger column; positive y: to a "
           "larger row");
  add_line(text, "seed", std::to_string(c.seed));
  add_line(text, "profile", o.profile);
  add_line(text, "size_px", o.size);
  add_line(text, "frame_rate_hz", c.frame_rate_hz);
  add_line(text, "speckle_px", c.speckle_px);
  add_line(text, "exposure_ratio", c.exposure_ratio);
  add_line(text, "rho", c.rho);
  add_line(text, "bit_depth", c.bit_depth);
  add_line(text, "mean_signal_counts", sim::mean_signal_counts(c));
  add_line(text, "noise_mean_counts", c.noise_mean_counts);
  add_line(text, "noise_sd_counts", c.noise_sd_counts);
  if (c.full_well_electrons) add_line(text, "full_well_electrons", *c.full_well_electrons);
  text += "frame,time_s,x_px,y_px,dx_px,dy_px\n";
  return text;
}

std::string truth_row(const Frame& frame, const sim::PatternMotion& before,
                      const sim::PatternMotion& now) {
  constexpr int kDecimals = 9;
  std::string text;
  append_integer(text, frame.index);
  text += ',';
  append_seconds(text, frame.stamp.ns);
  text += ',';
  append_fixed(text, now.x_px, kDecimals);
  text += ',';
  append_fixed(text, now.y_px, kDecimals);
  text += ',';
  if (frame.index > 0) append_fixed(text, now.x_px - before.x_px, kDecimals);
  text += ',';
  if (frame.index > 0) append_fixed(text, now.y_px - before.y_px, kDecimals);
  text += '\n';
  return text;
}

void show_progress(std::int64_t done, std::int64_t frames) {
  if (!::isatty(STDERR_FILENO) || (done % 16 != 0 && done != frames)) return;
  std::fprintf(stderr, "\rframe %lld of %lld%s", static_cast<long long>(done),
               static_cast<long long>(frames), done == frames ? "\n" : "");
}

/// The exit code.
Result<int> simulate(const SimulateOptions& options, const std::string& command) {
  if (options.frames < 1 || options.frames > kMaxFrames)
    return usage("--frames is " + std::to_string(options.frames) + " but must be in [1, " +
                 std::to_string(kMaxFrames) + "]");
  const auto format = file_format(options);
  if (!format) return format.error();
  const auto profile = profile_for(options);
  if (!profile) return profile.error();
  auto camera = sim::SpeckleCamera::create(options.camera);
  if (!camera) return camera.error();
  auto recording = Recording::begin(options, format.value());
  if (!recording) return recording.error();

  if (auto done = recording.value().add_truth(truth_head(options, command)); !done)
    return done.error();
  catch_interrupts();
  sim::PatternMotion before;
  Frame frame;
  for (std::int64_t k = 0; k < options.frames && !interrupted(); ++k) {
    const sim::PatternMotion now = profile.value()(k);
    if (auto done = camera.value().render(k, now, frame); !done) return done.error();
    if (auto done = recording.value().add_frame(frame); !done) return done.error();
    if (auto done = recording.value().add_truth(truth_row(frame, before, now)); !done)
      return done.error();
    before = now;
    show_progress(k + 1, options.frames);
  }
  if (interrupted()) {
    std::fputs("lsv: interrupted, nothing was written\n", stderr);
    return kExitInterrupted;
  }
  if (auto done = recording.value().commit(); !done) return done.error();
  return kExitOk;
}

/// The command as it can be typed again, without the directory of the program.
std::string command_line(const CLI::App& command) {
  std::string text = "lsv simulate speckle";
  for (const CLI::Option* option : command.parse_order()) {
    text += " " + option->get_name();
    for (const std::string& value : option->results()) text += " " + value;
  }
  return text;
}

int run(const CLI::App& command, SimulateOptions options) {
  if (auto parsed = parse_size(options.size, options.camera); !parsed)
    return report_error(parsed.error());
  if (command.count("--mean-counts") > 0) options.camera.mean_signal_counts = options.mean_counts;
  if (command.count("--full-well") > 0)
    options.camera.full_well_electrons = options.full_well_electrons;
  const Result<int> exit_code = simulate(options, command_line(command));
  return exit_code ? exit_code.value() : report_error(exit_code.error());
}

void add_options(CLI::App& command, SimulateOptions& o) {
  command
      .add_option("-o,--output", o.output, "Directory for the frames, or a .tif file for a stack")
      ->required();
  command.add_option("--truth", o.truth,
                     "File of the true motion (default: truth.csv beside the "
                     "frames)");
  command.add_option("--format", o.format, "png (default), tiff, pgm or raw, in a directory");
  command.add_option("--frames", o.frames, "Number of frames")->capture_default_str();
  command.add_option("--size", o.size, "Width x height, px")->capture_default_str();
  command.add_option("--rate-hz", o.camera.frame_rate_hz, "Frames per second")
      ->capture_default_str();
  command.add_option("--profile", o.profile, "Motion, see below")->capture_default_str();
  command.add_option("--speed-px", o.speed_px, "Greatest speed along x, px per frame")
      ->capture_default_str();
  command.add_option("--speed-y-px", o.speed_y_px, "Greatest speed along y, px per frame")
      ->capture_default_str();
  command.add_option("--period-frames", o.period_frames, "Period of the sinusoid, frames")
      ->capture_default_str();
  command
      .add_option("--speckle-px", o.camera.speckle_px,
                  "Speckle size (FWHM of the "
                  "autocovariance), px")
      ->capture_default_str();
  command
      .add_option("--rho", o.camera.rho,
                  "Boiling: intensity correlation of consecutive frames at rest; 1 = none")
      ->capture_default_str();
  command.add_option("--exposure", o.camera.exposure_ratio, "Exposure / frame interval, 0 to 1")
      ->capture_default_str();
  command.add_option("--bit-depth", o.camera.bit_depth, "8, 10, 12 or 16")->capture_default_str();
  command.add_option("--mean-counts", o.mean_counts,
                     "Mean signal above the dark level, counts (default: 60/255 of full scale)");
  command.add_option("--noise-mean", o.camera.noise_mean_counts, "Dark level, counts")
      ->capture_default_str();
  command.add_option("--noise-sd", o.camera.noise_sd_counts, "Camera noise, counts")
      ->capture_default_str();
  command.add_option("--full-well", o.full_well_electrons,
                     "Electrons at full scale; turns shot noise on");
  command.add_option("--seed", o.camera.seed, "Random seed")->capture_default_str();
}

}  // namespace

void add_simulate_command(CLI::App& app, int& exit_code) {
  CLI::App* simulate_group =
      app.add_subcommand("simulate", "Make frames or tracks whose motion is known");
  simulate_group->require_subcommand(1);
  CLI::App* speckle = simulate_group->add_subcommand("speckle",
                                                     "Laser speckle that moves in its "
                                                     "plane");
  speckle->footer(kExample);
  const auto options = std::make_shared<SimulateOptions>();
  add_options(*speckle, *options);
  speckle->callback([speckle, options, &exit_code] { exit_code = run(*speckle, *options); });
  add_simulate_tracks(*simulate_group, exit_code);
}

}  // namespace lsv::cli
