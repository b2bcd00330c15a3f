// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate noise`: what sigma to expect, and which window, rate and exposure to use.
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "calibration/calibration_io.h"
#include "lsv/core/frame.h"
#include "lsv/output/output_file.h"
#include "tools/commands.h"
#include "tools/noise_report.h"
#include "tools/number_option.h"
#include "tools/output_names.h"
#include "tools/size_option.h"

namespace lsv::cli {
namespace {

constexpr double kDefaultUpdate_hz = 100.0;

constexpr const char* kFooter =
    "Says the sigma of one shift between two frames (preset precise), of the velocity in steady\n"
    "tracking and of the position, and which window, rate and exposure give the least. What was\n"
    "simulated: windows of 48 to 512 px, speckle of 2.5 to 9 px, up to 1.5 speckles of blur, mean\n"
    "signal up to 0.4 of full scale, correlation from 0.5; beyond there is no prediction.\n"
    "Camera noise and dark level are those of the calibration unless given. The motion goes along\n"
    "image x. Model: docs/noise.md.\n"
    "\n"
    "Example:\n"
    "  lsv calibrate noise --calibration sample_frames/calibration.toml --size 128x128 \\\n"
    "      --rate-hz 1000 --exposure-us 200 --speckle-px 4 --mean-counts 60 \\\n"
    "      --full-well-e 10000 --speed-mm-s 80 --camera-rates 64:2000,128:1000,256:500 -o out\n"
    "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input.";

struct NoiseOptions {
  std::string calibration;
  std::string size;
  double rate_hz = 0.0;
  double exposure_us = 0.0;
  double speckle_px = 0.0;
  double mean_counts = 0.0;
  double speed_mm_s = 0.0;
  double rho = 1.0;
  double full_well_e = 0.0;
  double noise_counts = 0.0;
  double dark_counts = 0.0;
  int bit_depth = 8;
  double update_hz = kDefaultUpdate_hz;
  std::string windows;
  std::string camera_rates;
  double push_us = 0.0;
  std::string folder;
  std::string json_path;
};

Error usage(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> out(1);
  for (const char c : text) {
    if (c == ',')
      out.emplace_back();
    else
      out.back() += c;
  }
  return out;
}

/// The whole text as a number.
template <typename Number>
bool read(std::string_view text, Number& out) {
  const char* const end = text.data() + text.size();
  const auto [at, status] = std::from_chars(text.data(), end, out);
  return status == std::errc() && at == end;
}

Result<std::vector<int>> windows_of(const std::string& text) {
  std::vector<int> out;
  for (const std::string& word : split(text)) {
    int side_px = 0;
    if (!read(word, side_px) || side_px < 48 || side_px > 512)
      return usage("--windows is \"" + text +
                   "\" but must be sides from 48 to 512 px, such as 64,128,256");
    out.push_back(side_px);
  }
  std::sort(out.begin(), out.end());
  return out;
}

Result<std::vector<CameraRate>> camera_rates_of(const std::string& text) {
  std::vector<CameraRate> out;
  for (const std::string& word : split(text)) {
    const std::size_t colon = word.find(':');
    CameraRate rate;
    if (colon == std::string::npos ||
        !read(std::string_view(word).substr(0, colon), rate.window_px) ||
        !read(std::string_view(word).substr(colon + 1), rate.rate_hz) || rate.window_px < 1 ||
        !(rate.rate_hz >= 1e-3 && rate.rate_hz <= 1e7))
      return usage("--camera-rates is \"" + text +
                   "\" but must be WINDOW:HZ pairs, such as 64:2000,128:1000");
    out.push_back(rate);
  }
  std::sort(out.begin(), out.end(),
            [](const CameraRate& a, const CameraRate& b) { return a.window_px < b.window_px; });
  return out;
}

Result<void> take_size(const CLI::App& command, const NoiseOptions& o, NoiseInput& in) {
  sim::SpeckleConfig frame;
  if (command.count("--size") > 0) {
    if (Result<void> parsed = parse_size(o.size, frame); !parsed) return parsed;
  } else if (in.calibration.format) {
    frame.width_px = in.calibration.format->width_px;
    frame.height_px = in.calibration.format->height_px;
  } else {
    return usage("give --size: the calibration does not say how large the frames are");
  }
  if (frame.width_px < 1 || frame.height_px < 1)
    return usage("--size is " + o.size + " but each side must be at least 1 px");
  in.conditions.width_px = frame.width_px;
  in.conditions.height_px = frame.height_px;
  return {};
}

Result<void> take_camera(const CLI::App& command, const NoiseOptions& o, NoiseInput& in) {
  NoiseConditions& c = in.conditions;
  c.bit_depth = o.bit_depth;
  if (command.count("--bit-depth") == 0 && in.calibration.format)
    c.bit_depth = in.calibration.format->bit_depth;
  if (c.bit_depth < 8 || c.bit_depth > 16) return usage("--bit-depth must be 8 to 16");
  c.dark_counts = in.calibration.noise_mean_counts;
  c.noise_sd_counts = in.calibration.noise_sd_counts;
  const double full_counts = full_scale_counts(c.bit_depth);
  double full_well_e = kUnknown;
  for (const NumberOption& number :
       {NumberOption{"--mean-counts", o.mean_counts, 1.0, 0.0, full_counts, &c.mean_signal_counts},
        NumberOption{"--dark-counts", o.dark_counts, 1.0, 0.0, full_counts, &c.dark_counts},
        NumberOption{"--noise-counts", o.noise_counts, 1.0, 0.0, full_counts, &c.noise_sd_counts},
        NumberOption{"--full-well-e", o.full_well_e, 1.0, 1.0, 1e9, &full_well_e}}) {
    if (Result<void> taken = take(command, number); !taken) return taken;
  }
  if (command.count("--full-well-e") > 0) c.electrons_per_count = full_well_e / full_counts;
  if (c.dark_counts >= full_counts)
    return usage("the dark level is at full scale: give --bit-depth or --dark-counts");
  return {};
}

Result<NoiseInput> noise_input(const CLI::App& command, const NoiseOptions& o) {
  NoiseInput in;
  NoiseConditions& c = in.conditions;
  const NumberOption numbers[] = {{"--rate-hz", o.rate_hz, 1.0, 1e-3, 1e7, &in.rate_hz},
                                  {"--exposure-us", o.exposure_us, 1e-6, 1e-2, 1e9, &in.exposure_s},
                                  {"--speckle-px", o.speckle_px, 1.0, 0.1, 1e3, &c.speckle_px},
                                  {"--speed-mm-s", o.speed_mm_s, 1e-3, 1e-6, 1e8, &in.speed_m_s},
                                  {"--rho", o.rho, 1.0, 0.0, 1.0, &c.rho},
                                  {"--update-hz", o.update_hz, 1.0, 1e-3, 1e7, &in.update_hz},
                                  {"--push-us", o.push_us, 1e-6, 1e-3, 1e9, &in.push_s}};
  for (const NumberOption& number : numbers) {
    if (Result<void> taken = take(command, number); !taken) return taken.error();
  }
  constexpr double kRounding = 1.0 + 1e-9;
  if (in.exposure_s * in.rate_hz > kRounding)
    return usage("--exposure-us is longer than the time between frames at --rate-hz");
  if (command.count("--update-hz") == 0) in.update_hz = std::min(kDefaultUpdate_hz, in.rate_hz);
  if (command.count("--windows") > 0) {
    Result<std::vector<int>> windows = windows_of(o.windows);
    if (!windows) return windows.error();
    in.windows_px = std::move(windows).value();
  }
  if (command.count("--camera-rates") > 0) {
    Result<std::vector<CameraRate>> rates = camera_rates_of(o.camera_rates);
    if (!rates) return rates.error();
    in.camera_rates = std::move(rates).value();
  }
  Result<Calibration> calibration = load_calibration(o.calibration);
  if (!calibration) return calibration.error();
  in.calibration = std::move(calibration).value();
  if (Result<void> taken = take_size(command, o, in); !taken) return taken.error();
  if (Result<void> taken = take_camera(command, o, in); !taken) return taken.error();
  return in;
}

Result<void> write_folder(const NoiseReport& report, const NoiseOptions& o) {
  std::error_code status;
  std::filesystem::create_directories(o.folder, status);
  if (status)
    return Error{ErrorCode::output_failed, o.folder + ": cannot be created: " + status.message()};
  const std::filesystem::path folder(o.folder);
  const std::string page = (folder / "report.html").string();
  const std::string json = (folder / "noise.json").string();
  if (Result<void> fine = refuse_inputs({page, json}, {o.calibration}); !fine) return fine;
  if (Result<void> written = write_file(page, noise_html(report)); !written) return written;
  return write_file(json, noise_json(report));
}

Result<void> write_outputs(const NoiseReport& report, const NoiseOptions& o) {
  if (Result<void> fine = refuse_inputs({o.json_path}, {o.calibration}); !fine) return fine;
  if (!o.folder.empty()) {
    if (Result<void> written = write_folder(report, o); !written) return written;
  }
  if (!o.json_path.empty()) {
    if (Result<void> written = write_file(o.json_path, noise_json(report)); !written)
      return written;
  }
  if (o.json_path == "-") return {};
  return write_file("-", noise_text(report));
}

int run(const CLI::App& command, const NoiseOptions& options) {
  const Result<NoiseInput> input = noise_input(command, options);
  if (!input) return report_error(input.error());
  const Result<void> written = write_outputs(noise_report(input.value()), options);
  return written ? kExitOk : report_error(written.error());
}

void add_options(CLI::App& command, NoiseOptions& o) {
  command.add_option("--calibration", o.calibration, "Calibration file of the sensor")->required();
  command.add_option("--size", o.size, "Width x height of the frames, px; default: calibration");
  command.add_option("--rate-hz", o.rate_hz, "Frames per second")->required();
  command.add_option("--exposure-us", o.exposure_us, "Exposure of one frame")->required();
  command
      .add_option("--speckle-px", o.speckle_px,
                  "Speckle size: width of the autocovariance at half maximum")
      ->required();
  command
      .add_option("--mean-counts", o.mean_counts,
                  "Mean grey value above the dark level, at that exposure")
      ->required();
  command.add_option("--speed-mm-s", o.speed_mm_s, "Highest speed to be measured")->required();
  command
      .add_option("--rho", o.rho,
                  "Correlation of two consecutive frames once the motion is taken out, noise apart")
      ->capture_default_str();
  command.add_option("--full-well-e", o.full_well_e,
                     "Electrons at full scale; without it there is no shot noise");
  command.add_option("--noise-counts", o.noise_counts,
                     "Camera noise, standard deviation; default: calibration");
  command.add_option("--dark-counts", o.dark_counts, "Dark level; default: calibration");
  command.add_option("--bit-depth", o.bit_depth, "Bits per pixel; default: calibration, or 8");
  command
      .add_option("--update-hz", o.update_hz,
                  "How often a velocity is wanted: choices are compared over that time")
      ->capture_default_str();
  command.add_option("--windows", o.windows, "Sides to choose from, px, such as 64,128,256");
  command.add_option(
      "--camera-rates", o.camera_rates,
      "Fastest rate by window, such as 64:2000,128:1000; default: --rate-hz for all");
  command.add_option("--push-us", o.push_us,
                     "Time of one push at --size (lsv budget); rates must leave half of it");
  command.add_option("-o,--output", o.folder, "Folder for report.html and noise.json");
  command.add_option("--json", o.json_path,
                     "Also write the numbers as JSON; - for only that, on standard output");
}

}  // namespace

void add_calibrate_noise(CLI::App& calibrate, int& exit_code) {
  CLI::App* const noise = calibrate.add_subcommand(
      "noise", "Predict the sigma of shift and velocity; choose window, rate and exposure");
  noise->footer(kFooter);
  const auto options = std::make_shared<NoiseOptions>();
  add_options(*noise, *options);
  noise->callback([noise, options, &exit_code] { exit_code = run(*noise, *options); });
}

}  // namespace lsv::cli
