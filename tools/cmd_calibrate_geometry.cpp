// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate geometry`: what the optics say about the scale, before anything is measured.
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "lsv/output/output_file.h"
#include "tools/commands.h"
#include "tools/geometry_report.h"
#include "tools/number_option.h"
#include "tools/size_option.h"

namespace lsv::cli {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMaxSide_px = 65535;

constexpr const char* kFooter =
    "Objective speckle (no lens): Sc = 1 + sensor distance / source distance, both from the\n"
    "surface. The source distance is the radius of the wavefront at the surface: behind a\n"
    "collimator the source is virtual and far away. Imaged speckle: Sc is the magnification.\n"
    "With --measured-sc it says which single error of the geometry would explain the difference.\n"
    "Equations and assumptions: docs/geometry.md.\n"
    "\n"
    "Example:\n"
    "  lsv calibrate geometry --source-distance-m 0.1 --sensor-distance-m 0.1 \\\n"
    "      --wavelength-nm 532 --spot-mm 1.2 --pixel-um 14 --rate-hz 1000 --size 128x128 \\\n"
    "      --speed-mm-s 80 --measured-sc 1.985 --measured-sc-sigma 0.002\n"
    "  lsv calibrate geometry --magnification 0.25 --f-number 8 --focal-mm 25 --collimated\n";

struct GeometryOptions {
  double source_distance_m = 0.0;
  double sensor_distance_m = 0.0;
  bool collimated = false;
  double wavelength_nm = 0.0;
  double spot_mm = 0.0;
  double pixel_um = 0.0;
  double rate_hz = 0.0;
  std::string size;
  double magnification = 0.0;
  double f_number = 0.0;
  double focal_mm = 0.0;
  double speed_mm_s = 0.0;
  double sigma_px = 0.01;
  double measured_sc = 0.0;
  double measured_sc_sigma = 0.0;
  std::string json_path;
};

Error usage(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

/// The optics: no lens, or an image.
Result<void> check_model(const CLI::App& command) {
  const auto given = [&](const char* name) { return command.count(name) > 0; };
  if (given("--magnification")) {
    for (const char* objective : {"--sensor-distance-m", "--spot-mm"}) {
      if (given(objective))
        return usage(std::string(objective) +
                     " is for objective speckle (no lens) and --magnification for imaged speckle: "
                     "give one of them");
    }
    return {};
  }
  for (const char* imaged : {"--f-number", "--focal-mm"}) {
    if (given(imaged)) return usage(std::string(imaged) + " needs --magnification");
  }
  if (!given("--sensor-distance-m"))
    return usage("give --sensor-distance-m (no lens) or --magnification (camera with a lens)");
  if (!given("--source-distance-m") && !given("--collimated"))
    return usage(
        "give --source-distance-m, from the virtual source to the surface, or --collimated");
  return {};
}

Result<void> take_size(const std::string& text, GeometryInput& input) {
  sim::SpeckleConfig frame;
  if (auto parsed = parse_size(text, frame); !parsed) return parsed;
  for (const int side_px : {frame.width_px, frame.height_px}) {
    if (side_px < 1 || side_px > kMaxSide_px)
      return usage("--size is " + text + " but each side must be between 1 and " +
                   std::to_string(kMaxSide_px) + " px");
  }
  input.width_px = frame.width_px;
  input.height_px = frame.height_px;
  return {};
}

Result<GeometryInput> geometry_input(const CLI::App& command, const GeometryOptions& o) {
  if (auto fits = check_model(command); !fits) return fits.error();
  if (command.count("--measured-sc-sigma") > 0 && command.count("--measured-sc") == 0)
    return usage("--measured-sc-sigma needs --measured-sc");
  GeometryInput in;
  in.sigma_px = o.sigma_px;
  const NumberOption numbers[] = {
      {"--source-distance-m", o.source_distance_m, 1.0, 1e-4, 1e4, &in.distances.source_distance_m},
      {"--sensor-distance-m", o.sensor_distance_m, 1.0, 1e-4, 10.0,
       &in.distances.sensor_distance_m},
      {"--wavelength-nm", o.wavelength_nm, 1e-9, 100.0, 20000.0, &in.wavelength_m},
      {"--spot-mm", o.spot_mm, 1e-3, 1e-3, 1e3, &in.spot_diameter_m},
      {"--pixel-um", o.pixel_um, 1e-6, 0.1, 1e3, &in.pixel_pitch_m},
      {"--rate-hz", o.rate_hz, 1.0, 1e-3, 1e7, &in.rate_hz},
      {"--magnification", o.magnification, 1.0, 1e-4, 1e3, &in.magnification_ratio},
      {"--f-number", o.f_number, 1.0, 0.1, 1e3, &in.f_number},
      {"--focal-mm", o.focal_mm, 1e-3, 0.1, 1e5, &in.focal_length_m},
      {"--speed-mm-s", o.speed_mm_s, 1e-3, 1e-6, 1e8, &in.speed_m_s},
      {"--sigma-px", o.sigma_px, 1.0, 0.0, 1e3, &in.sigma_px},
      {"--measured-sc", o.measured_sc, 1.0, 1e-4, 1e3, &in.measured_sc_ratio},
      {"--measured-sc-sigma", o.measured_sc_sigma, 1.0, 0.0, 1e3, &in.measured_sc_sigma_ratio}};
  for (const NumberOption& number : numbers) {
    if (auto taken = take(command, number); !taken) return taken.error();
  }
  if (o.collimated) in.distances.source_distance_m = kInfinity;
  if (command.count("--size") > 0) {
    if (auto taken = take_size(o.size, in); !taken) return taken.error();
  }
  return in;
}

Result<void> write_report(const GeometryReport& report, const std::string& json_path) {
  if (!json_path.empty()) {
    if (Result<void> written = write_file(json_path, geometry_json(report)); !written)
      return written;
  }
  if (json_path == "-") return {};
  return write_file("-", geometry_text(report));
}

int run(const CLI::App& command, const GeometryOptions& options) {
  const Result<GeometryInput> input = geometry_input(command, options);
  if (!input) return report_error(input.error());
  const Result<void> written = write_report(predict(input.value()), options.json_path);
  return written ? kExitOk : report_error(written.error());
}

void add_options(CLI::App& command, GeometryOptions& o) {
  CLI::Option* const source =
      command.add_option("--source-distance-m", o.source_distance_m,
                         "Virtual source to surface: radius of the wavefront at the surface");
  command.add_flag("--collimated", o.collimated, "Flat wavefronts: the source is at infinity")
      ->excludes(source);
  command.add_option("--sensor-distance-m", o.sensor_distance_m,
                     "Surface to sensor, no lens between them");
  command.add_option("--spot-mm", o.spot_mm, "Diameter of the lit spot on the surface (1/e^2)");
  command.add_option("--magnification", o.magnification,
                     "Image size / object size of a camera focused on the surface");
  command.add_option("--f-number", o.f_number, "F-number of its lens");
  command.add_option("--focal-mm", o.focal_mm, "Focal length of its lens");
  command.add_option("--wavelength-nm", o.wavelength_nm, "Wavelength of the laser");
  command.add_option("--pixel-um", o.pixel_um, "Pixel pitch");
  command.add_option("--rate-hz", o.rate_hz, "Frames per second");
  command.add_option("--size", o.size, "Width x height of the window, px, such as 128x128");
  command.add_option("--speed-mm-s", o.speed_mm_s, "Tell this speed in px per frame");
  command.add_option("--sigma-px", o.sigma_px, "Tell this shift noise as velocity")
      ->capture_default_str();
  command.add_option("--measured-sc", o.measured_sc, "Explain this Sc, measured on the ground");
  command.add_option("--measured-sc-sigma", o.measured_sc_sigma, "One standard deviation of it");
  command.add_option("--json", o.json_path,
                     "Also write the numbers as JSON; - for only that, on standard output");
}

}  // namespace

void add_calibrate_geometry(CLI::App& calibrate, int& exit_code) {
  CLI::App* const geometry =
      calibrate.add_subcommand("geometry", "Predict the scale from the optics");
  geometry->footer(kFooter);
  const auto options = std::make_shared<GeometryOptions>();
  add_options(*geometry, *options);
  geometry->callback([geometry, options, &exit_code] { exit_code = run(*geometry, *options); });
}

}  // namespace lsv::cli
