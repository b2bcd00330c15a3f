// SPDX-License-Identifier: BSD-3-Clause
#include "tools/simulated_camera.h"

#include "tools/size_option.h"

namespace lsv::cli {

void add_camera_options(CLI::App& command, SimulatedCamera& camera) {
  sim::SpeckleConfig& c = camera.config;
  command.add_option("--size", camera.size, "Width x height, px")->capture_default_str();
  command.add_option("--rate-hz", c.frame_rate_hz, "Frames per second")->capture_default_str();
  command.add_option("--bit-depth", c.bit_depth, "8, 10, 12 or 16")->capture_default_str();
  command.add_option("--noise-mean", c.noise_mean_counts, "Dark level, counts")
      ->capture_default_str();
  command.add_option("--noise-sd", c.noise_sd_counts, "Camera noise, counts")
      ->capture_default_str();
  command.add_option("--full-well", camera.full_well_electrons,
                     "Electrons at full scale; turns shot noise on");
  command.add_option("--seed", c.seed, "Random seed")->capture_default_str();

  const std::string group = "Fixed pattern of the sensor";
  command
      .add_option("--dsnu-counts", c.sensor.dsnu_counts,
                  "Dark levels of the pixels, standard deviation, counts")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--prnu-percent", camera.prnu_percent,
                  "Gains of the pixels, standard deviation, %")
      ->capture_default_str()
      ->group(group);
  command.add_option("--hot-pixels", c.sensor.hot_pixels, "Pixels that are always at full scale")
      ->capture_default_str()
      ->group(group);
  command.add_option("--dead-pixels", c.sensor.dead_pixels, "Pixels that are always 0")
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--sensor-seed", camera.sensor_seed,
                  "Which sensor it is (default: that of --seed)")
      ->group(group);
}

void add_speckle_options(CLI::App& command, SimulatedCamera& camera) {
  command
      .add_option("--speckle-px", camera.config.speckle_px,
                  "Speckle size (FWHM of the autocovariance), px")
      ->capture_default_str();
  command
      .add_option("--exposure", camera.config.exposure_ratio, "Exposure / frame interval, 0 to 1")
      ->capture_default_str();
  command.add_option("--mean-counts", camera.mean_counts,
                     "Mean signal above the dark level, counts (default: 60/255 of full scale)");
}

Result<void> resolve_camera(const CLI::App& command, SimulatedCamera& camera) {
  if (Result<void> parsed = parse_size(camera.size, camera.config); !parsed) return parsed;
  if (command.count("--mean-counts") > 0) camera.config.mean_signal_counts = camera.mean_counts;
  if (command.count("--full-well") > 0)
    camera.config.full_well_electrons = camera.full_well_electrons;
  if (command.count("--sensor-seed") > 0) camera.config.sensor.seed = camera.sensor_seed;
  camera.config.sensor.prnu_ratio = camera.prnu_percent / 100.0;
  return {};
}

std::string command_line(const CLI::App& command, const std::string& parent) {
  std::string text = parent + command.get_name();
  for (const CLI::Option* option : command.parse_order()) {
    text += " " + option->get_name();
    for (const std::string& value : option->results()) text += " " + value;
  }
  return text;
}

}  // namespace lsv::cli
