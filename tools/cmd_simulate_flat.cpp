// SPDX-License-Identifier: BSD-3-Clause
// `lsv simulate flat`: frames of even light, or of none, as `lsv calibrate camera` wants them.
#include <memory>
#include <string>

#include "sim/flat_field.h"
#include "tools/commands.h"
#include "tools/recording.h"
#include "tools/simulated_camera.h"

namespace lsv::cli {
namespace {

constexpr const char* kFooter =
    "With the same sensor options and the same --seed, or --sensor-seed, `lsv simulate speckle` "
    "sees\n"
    "the same sensor. Nothing is overwritten.\n"
    "\n"
    "Example:\n"
    "  lsv simulate flat -o cam/dark.tif --mean-counts 0 --frames 50 --noise-mean 15 \\\n"
    "      --dsnu-counts 5 --prnu-percent 2 --full-well 10000 --seed 7\n"
    "  lsv simulate flat -o cam/flat100.tif --mean-counts 100 --frames 50 --noise-mean 15 \\\n"
    "      --dsnu-counts 5 --prnu-percent 2 --full-well 10000 --seed 7";

struct FlatOptions {
  std::string output;
  std::string format;
  std::int64_t frames = 50;
  double gradient_percent = 0.0;
  SimulatedCamera camera;
};

Result<int> simulate(const FlatOptions& options) {
  if (auto checked = check_frame_count(options.frames); !checked) return checked.error();
  const sim::SpeckleConfig& config = options.camera.config;
  auto camera = sim::FlatFieldCamera::create(config, options.gradient_percent / 100.0);
  if (!camera) return camera.error();
  const FrameFormat format = sim::frame_format(config);
  auto recording =
      Recording::begin({.output = options.output,
                        .format = options.format,
                        .pixel_bytes = options.frames * format.width_px * format.height_px *
                                       static_cast<std::int64_t>(bytes_per_pixel(format.type))});
  if (!recording) return recording.error();
  Frame frame;
  return record_frames(std::move(recording).value(), options.frames,
                       [&](std::int64_t k, Recording& to) -> Result<void> {
                         if (auto done = camera.value().render(k, frame); !done) return done;
                         return to.add_frame(frame);
                       });
}

int run(const CLI::App& command, FlatOptions options) {
  if (auto resolved = resolve_camera(command, options.camera); !resolved)
    return report_error(resolved.error());
  const Result<int> exit_code = simulate(options);
  return exit_code ? exit_code.value() : report_error(exit_code.error());
}

}  // namespace

void add_simulate_flat(CLI::App& simulate_group, int& exit_code) {
  CLI::App* const flat =
      simulate_group.add_subcommand("flat", "Even light on the sensor, or darkness");
  const auto options = std::make_shared<FlatOptions>();
  FlatOptions& o = *options;
  flat->add_option("-o,--output", o.output, "Directory for the frames, or a .tif file for a stack")
      ->required();
  flat->add_option("--mean-counts", o.camera.mean_counts,
                   "Light: mean signal above the dark level, counts; 0 is dark")
      ->required();
  flat->add_option("--gradient-percent", o.gradient_percent,
                   "How much more light falls on the last column than on the first, % of the mean")
      ->capture_default_str();
  flat->add_option("--frames", o.frames, "Number of frames")->capture_default_str();
  flat->add_option("--format", o.format, "png (default), tiff, pgm or raw, in a directory");
  add_camera_options(*flat, o.camera);
  flat->footer(kFooter);
  flat->callback([flat, options, &exit_code] { exit_code = run(*flat, *options); });
}

}  // namespace lsv::cli
