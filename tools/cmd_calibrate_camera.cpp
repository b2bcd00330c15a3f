// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate camera`: gain, noise and fixed pattern of a camera from dark and flat frames.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calibration/calibration_io.h"
#include "calibration/camera_warnings.h"
#include "calibration/sensor_format.h"
#include "calibration/sensor_maps_io.h"
#include "calibration/sha256.h"
#include "lsv/output/output_file.h"
#include "tools/camera_frames.h"
#include "tools/camera_report.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/output_names.h"
#include "tools/settings.h"
#include "tools/track_settings.h"

namespace lsv::cli {
namespace {

constexpr const char* kMapsName = "sensor_maps.tif";

constexpr const char* kFooter =
    "FRAMES is a folder, a quoted pattern, a TIFF stack, a raw file or a video: at least 16 "
    "frames,\n"
    "better 50, of the bare sensor (no lens) in the dark, and the same at two or more levels of\n"
    "steady, even light. Five levels up to 70 % of saturation and one that is overexposed tell "
    "all.\n"
    "The new calibration is that of --calibration with the camera replaced; `lsv track` finds the\n"
    "maps beside it. EMVA 1288, release 4.0, linear model: docs/camera.md.\n"
    "\n"
    "Example, with a simulated camera (bash):\n"
    "  SENSOR='--noise-mean 15 --dsnu-counts 5 --prnu-percent 2 --hot-pixels 20 --full-well "
    "10000'\n"
    "  for L in 0 30 60 90 120 150 200 400; do\n"
    "      lsv simulate flat -o cam/light$L.tif --mean-counts $L $SENSOR; done\n"
    "  lsv calibrate camera --dark cam/light0.tif --flat=cam/light{30,60,90,120,150,200,400}.tif "
    "\\\n"
    "      --calibration sample_frames/calibration.toml -o cam/out\n"
    "  lsv simulate speckle -o cam/drive.tif --profile constant --speed-px 0.5 $SENSOR\n"
    "  lsv track cam/drive.tif --rate-hz 1000 --calibration cam/out/calibration.toml -o cam/track\n"
    "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input, 130 interrupted.";

struct CameraOptions {
  std::string dark;
  std::vector<std::string> flats;
  std::vector<double> exposures_us;
  std::string calibration;
  std::string output;
  std::string date;
  std::string method = "lsv calibrate camera";
  SourceOptions source;
  Settings settings;
};

std::string in_folder(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / name).string();
}

Result<void> check(const CameraOptions& options) {
  const auto usage = [](const char* sentence) {
    return Error{ErrorCode::invalid_argument, sentence};
  };
  if (options.source.roi)
    return usage("--roi: the maps are of the whole frame; lsv track cuts them to its region");
  if (!options.exposures_us.empty() && options.exposures_us.size() != options.flats.size())
    return usage("--exposure-us must be given as often as --flat, in the same order");
  const bool positive = std::ranges::all_of(
      options.exposures_us, [](double value) { return value > 0.0 && value < 1e15; });
  if (!positive) return usage("--exposure-us must be above 0");
  return {};
}

/// What the command writes, the calibration last: it vouches for the maps.
struct Outputs {
  std::string maps;
  CameraReport report;
  std::vector<std::string> inputs;
};

Result<Outputs> measure(const CameraOptions& options) {
  Result<Calibration> base = load_calibration(options.calibration);
  if (!base) return base.error();
  Result<CameraFrames> frames =
      read_camera_frames(options.dark, options.flats, options.exposures_us, options.source);
  if (!frames) return frames.error();
  Outputs out;
  if (interrupted()) return out;
  const FrameFormat& format = frames.value().dark.statistics.format();
  if (Result<void> fits = check_format(base.value(), options.calibration, format); !fits)
    return fits.error();
  Result<CameraCharacterisation> camera =
      characterise_camera(frames.value().dark, frames.value().flats);
  if (!camera) return camera.error();

  out.inputs = std::move(frames.value().files);
  out.inputs.push_back(options.calibration);
  out.report.warnings = std::move(frames.value().warnings);
  for (std::string& warning : camera_warnings(camera.value()))
    out.report.warnings.push_back(std::move(warning));
  Result<std::string> maps = sensor_maps_tiff(camera.value().maps);
  if (!maps) return maps.error();
  out.maps = std::move(maps).value();
  out.report.calibration = with_camera(base.value(), camera.value());
  out.report.calibration.maps = MapsRecord{.file = kMapsName, .sha256 = sha256_hex(out.maps)};
  CameraRecord& record = *out.report.calibration.camera;
  record.date = options.date;
  record.method = options.method;
  record.inputs_sha256 = frames.value().inputs_sha256;
  out.report.camera = std::move(camera).value();
  return out;
}

Result<void> write(const Outputs& outputs, const std::string& folder) {
  const std::string text = calibration_text(outputs.report.calibration);
  if (const Result<Calibration> read = parse_calibration(text, "the new calibration"); !read)
    return read.error();
  const std::pair<const char*, std::string> files[] = {{kMapsName, outputs.maps},
                                                       {"camera.json", camera_json(outputs.report)},
                                                       {"report.html", camera_html(outputs.report)},
                                                       {"calibration.toml", text}};
  std::vector<std::string> names;
  for (const auto& [name, bytes] : files) names.push_back(in_folder(folder, name));
  if (Result<void> checked = refuse_inputs(names, outputs.inputs); !checked) return checked;
  std::error_code status;
  std::filesystem::create_directories(folder, status);
  if (status)
    return Error{ErrorCode::output_failed, folder + ": cannot be created: " + status.message()};
  for (const auto& [name, bytes] : files) {
    if (Result<void> written = write_file(in_folder(folder, name), bytes); !written) return written;
  }
  return {};
}

Result<int> calibrate(CameraOptions& options) {
  if (Result<void> resolved =
          options.settings.resolve("", Settings::Variables::some_of_other_commands);
      !resolved)
    return resolved.error();
  options.source.need_time = false;
  if (Result<void> checked = check(options); !checked) return checked.error();
  catch_interrupts();
  const Result<Outputs> outputs = measure(options);
  if (!outputs) return outputs.error();
  if (interrupted()) {
    std::fputs("lsv: interrupted, nothing was written\n", stderr);
    return kExitInterrupted;
  }
  if (Result<void> written = write(outputs.value(), options.output); !written)
    return written.error();
  std::fputs(camera_text(outputs.value().report).c_str(), stdout);
  return std::fflush(stdout) == 0 ? kExitOk : kExitOutputFailed;
}

}  // namespace

void add_calibrate_camera(CLI::App& calibrate_group, int& exit_code) {
  CLI::App* const sub = calibrate_group.add_subcommand(
      "camera", "Measure gain, noise and fixed pattern of a camera (EMVA 1288)");
  const auto options = std::make_shared<CameraOptions>();
  CameraOptions& o = *options;
  sub->add_option("--dark", o.dark, "FRAMES without light")->required();
  sub->add_option("--flat", o.flats, "FRAMES of even light; once for each level of light")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub->add_option("--exposure-us", o.exposures_us,
                  "Exposure of each --flat, in their order, or anything in proportion to the "
                  "light: tells the linearity")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub->add_option("--calibration", o.calibration, "Calibration to start from (pixel pitch, scale)")
      ->required();
  sub->add_option("-o,--output", o.output,
                  "Folder for calibration.toml, sensor_maps.tif, camera.json and report.html")
      ->required();
  sub->add_option("--date", o.date, "Date to write into the calibration: outputs hold no other");
  sub->add_option("--method", o.method, "How it was measured")->capture_default_str();
  add_source_settings(*sub, o.settings, o.source);
  sub->footer(kFooter);
  sub->callback([options, &exit_code] {
    const Result<int> done = calibrate(*options);
    exit_code = done ? done.value() : report_error(done.error());
  });
}

}  // namespace lsv::cli
