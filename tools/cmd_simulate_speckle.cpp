// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate speckle`: simulated frames on disk, with the true motion beside them.
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "lsv/output/number_text.h"
#include "sim/speckle.h"
#include "tools/commands.h"
#include "tools/motion_options.h"
#include "tools/recording.h"
#include "tools/simulated_camera.h"

namespace lsv::cli {
namespace {

constexpr const char* kAbout =
    "Writes the frames and the true motion (truth.csv: pattern position at mid exposure and shift\n"
    "since the frame before, in px; positive x to larger columns). Nothing is overwritten.\n"
    "\n";
constexpr const char* kExample =
    "\n"
    "Example:\n"
    "  lsv simulate speckle -o run1 --frames 200 --profile drive --speed-px 5 --speed-y-px 1\n"
    "  lsv simulate speckle -o run2/boil.tif --rho 0.95 --profile constant --speed-px 0.25\n";

struct SpeckleOptions {
  std::string output;
  std::string truth;
  std::string format;
  std::int64_t frames = 200;
  MotionOptions motion;
  SimulatedCamera camera;
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

std::string truth_head(const SpeckleOptions& o, const std::string& command) {
  const sim::SpeckleConfig& c = o.camera.config;
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
  add_line(text, "profile", o.motion.profile);
  add_line(text, "size_px", o.camera.size);
  add_line(text, "frame_rate_hz", c.frame_rate_hz);
  add_line(text, "speckle_px", c.speckle_px);
  add_line(text, "exposure_ratio", c.exposure_ratio);
  add_line(text, "rho", c.rho);
  add_line(text, "bit_depth", c.bit_depth);
  add_line(text, "mean_signal_counts", sim::mean_signal_counts(c));
  add_line(text, "noise_mean_counts", c.noise_mean_counts);
  add_line(text, "noise_sd_counts", c.noise_sd_counts);
  if (c.full_well_electrons) add_line(text, "full_well_electrons", *c.full_well_electrons);
  const std::pair<const char*, double> pattern[] = {
      {"dsnu_counts", c.sensor.dsnu_counts},
      {"prnu_ratio", c.sensor.prnu_ratio},
      {"hot_pixels", static_cast<double>(c.sensor.hot_pixels)},
      {"dead_pixels", static_cast<double>(c.sensor.dead_pixels)}};
  for (const auto& [key, value] : pattern) {
    if (value > 0.0) add_line(text, key, value);
  }
  if (c.sensor.seed) add_line(text, "sensor_seed", std::to_string(*c.sensor.seed));
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

/// The exit code.
Result<int> simulate(const SpeckleOptions& options, const std::string& command) {
  if (auto checked = check_frame_count(options.frames); !checked) return checked.error();
  const auto profile = motion_profile(options.motion, options.frames, options.camera.config.seed);
  if (!profile) return profile.error();
  const sim::SpeckleConfig& config = options.camera.config;
  auto camera = sim::SpeckleCamera::create(config);
  if (!camera) return camera.error();
  const FrameFormat format = sim::frame_format(config);
  auto recording =
      Recording::begin({.output = options.output,
                        .format = options.format,
                        .truth = options.truth,
                        .pixel_bytes = options.frames * format.width_px * format.height_px *
                                       static_cast<std::int64_t>(bytes_per_pixel(format.type))});
  if (!recording) return recording.error();

  if (auto done = recording.value().add_truth(truth_head(options, command)); !done)
    return done.error();
  sim::PatternMotion before;
  Frame frame;
  return record_frames(std::move(recording).value(), options.frames,
                       [&](std::int64_t k, Recording& to) -> Result<void> {
                         const sim::PatternMotion now = profile.value()(k);
                         if (auto done = camera.value().render(k, now, frame); !done) return done;
                         if (auto done = to.add_frame(frame); !done) return done;
                         if (auto done = to.add_truth(truth_row(frame, before, now)); !done)
                           return done;
                         before = now;
                         return {};
                       });
}

int run(const CLI::App& command, SpeckleOptions options) {
  if (auto resolved = resolve_camera(command, options.camera); !resolved)
    return report_error(resolved.error());
  const Result<int> exit_code = simulate(options, command_line(command));
  return exit_code ? exit_code.value() : report_error(exit_code.error());
}

void add_options(CLI::App& command, SpeckleOptions& o) {
  command
      .add_option("-o,--output", o.output, "Directory for the frames, or a .tif file for a stack")
      ->required();
  command.add_option("--truth", o.truth,
                     "File of the true motion (default: truth.csv beside the "
                     "frames)");
  command.add_option("--format", o.format, "png (default), tiff, pgm or raw, in a directory");
  command.add_option("--frames", o.frames, "Number of frames")->capture_default_str();
  add_motion_options(command, o.motion);
  command
      .add_option("--rho", o.camera.config.rho,
                  "Boiling: intensity correlation of consecutive frames at rest; 1 = none")
      ->capture_default_str();
  add_speckle_options(command, o.camera);
  add_camera_options(command, o.camera);
}

}  // namespace

void add_simulate_speckle(CLI::App& simulate_group, int& exit_code) {
  CLI::App* const speckle =
      simulate_group.add_subcommand("speckle", "Laser speckle that moves in its plane");
  speckle->footer(std::string(kAbout) + kMotionHelp + kExample);
  const auto options = std::make_shared<SpeckleOptions>();
  add_options(*speckle, *options);
  speckle->callback([speckle, options, &exit_code] { exit_code = run(*speckle, *options); });
}

}  // namespace lsv::cli
