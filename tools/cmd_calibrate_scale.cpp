// SPDX-License-Identifier: BSD-3-Clause
// `lsv calibrate scale`: the scale of a sensor from runs of known travel.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "calibration/calibration_io.h"
#include "calibration/sensor_maps_io.h"
#include "lsv/output/output_file.h"
#include "tools/commands.h"
#include "tools/output_names.h"
#include "tools/scale_report.h"
#include "tools/scale_runs.h"

namespace lsv::cli {
namespace {

constexpr const char* kFooter =
    "RUNS is a CSV table with one row per run; file names are relative to its folder:\n"
    "  track,travel_x_m,travel_y_m,sigma_m    end to end, measured with a stage or a tape\n"
    "  track,truth,sigma_m                    a file with time_s,x_m,y_m along the way instead\n"
    "track is what `lsv track --csv` wrote. The runs must go in two directions at least. The new\n"
    "calibration is that of --calibration with the scale replaced.\n"
    "\n"
    "Example:\n"
    "  lsv calibrate scale runs.csv --calibration sample_frames/calibration.toml \\\n"
    "      --height-m 0.1 --date 2026-11-24 --method \"stage, 50 mm\" -o out\n"
    "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input.";

struct ScaleOptions {
  std::string runs;
  std::string calibration;
  std::string output;
  std::string date;
  std::string method = "lsv calibrate scale";
  double height_m = 0.0;
  double sigma_percent = 0.0;
};

Result<ScaleReport> measure(const ScaleOptions& options, std::optional<double> sigma_ratio) {
  Result<Calibration> base = load_calibration(options.calibration);
  if (!base) return base.error();
  Result<ScaleRuns> runs = read_scale_runs(options.runs, sigma_ratio);
  if (!runs) return runs.error();
  Result<ScaleFit> fit =
      fit_scale(runs.value().runs, base.value().pixel_pitch_x_m, base.value().pixel_pitch_y_m);
  if (!fit) return Error{fit.error().code, options.runs + ": " + fit.error().message};
  ScaleReport out{.calibration = with_maps_seen_from(
                      options.output, with_scale(base.value(), fit.value()), options.calibration),
                  .fit = std::move(fit).value(),
                  .runs = std::move(runs.value().runs),
                  .change = {},
                  .warnings = std::move(runs.value().warnings)};
  ScaleRecord& record = *out.calibration.scale;
  record.height_m = options.height_m;
  record.date = options.date;
  record.method = options.method;
  record.inputs_sha256 = runs.value().inputs_sha256;
  if (base.value().scale) out.change = compare_scales(base.value(), out.calibration);
  return out;
}

struct OutputPaths {
  std::string calibration, report;
};

OutputPaths paths_in(const std::filesystem::path& folder) {
  return {.calibration = (folder / "calibration.toml").string(),
          .report = (folder / "scale.html").string()};
}

Result<void> write_outputs(const ScaleReport& report, const std::string& folder) {
  const std::string text = calibration_text(report.calibration);
  if (const Result<Calibration> read = parse_calibration(text, "the new calibration"); !read)
    return read.error();
  std::error_code status;
  std::filesystem::create_directories(folder, status);
  if (status)
    return Error{ErrorCode::output_failed, folder + ": cannot be created: " + status.message()};
  const OutputPaths paths = paths_in(folder);
  if (Result<void> written = write_file(paths.report, scale_html(report)); !written) return written;
  return write_file(paths.calibration, text);
}

int run(const CLI::App& command, const ScaleOptions& options) {
  const auto usage = [](const char* sentence) {
    return report_error({ErrorCode::invalid_argument, sentence});
  };
  std::optional<double> sigma_ratio;
  if (command.count("--reference-sigma-percent") > 0) {
    if (!(options.sigma_percent > 0.0 && options.sigma_percent <= 50.0))
      return usage("--reference-sigma-percent must be above 0 and at most 50");
    sigma_ratio = options.sigma_percent / 100.0;
  }
  if (!(options.height_m >= 1e-4 && options.height_m <= 100.0))
    return usage("--height-m must be between 0.0001 and 100");
  const OutputPaths paths = paths_in(options.output);
  if (const Result<void> apart =
          refuse_inputs({paths.calibration, paths.report}, {options.calibration, options.runs});
      !apart)
    return report_error(apart.error());
  const Result<ScaleReport> report = measure(options, sigma_ratio);
  if (!report) return report_error(report.error());
  if (Result<void> written = write_outputs(report.value(), options.output); !written)
    return report_error(written.error());
  std::fputs(scale_text(report.value()).c_str(), stdout);
  return std::fflush(stdout) == 0 ? kExitOk : kExitOutputFailed;
}

}  // namespace

void add_calibrate_scale(CLI::App& calibrate, int& exit_code) {
  CLI::App* const sub =
      calibrate.add_subcommand("scale", "Fit the scale to runs of known travel, with sigmas");
  const auto options = std::make_shared<ScaleOptions>();
  ScaleOptions& o = *options;
  sub->add_option("RUNS", o.runs, "Table of the runs (CSV)")->required();
  sub->add_option("--calibration", o.calibration, "Calibration to start from (pixel pitch, camera)")
      ->required();
  sub->add_option("-o,--output", o.output, "Folder for calibration.toml and scale.html")
      ->required();
  sub->add_option("--height-m", o.height_m, "Height of the sensor at which the scale holds, m")
      ->required();
  sub->add_option("--date", o.date, "Date to write into the calibration: outputs hold no other")
      ->required();
  sub->add_option("--method", o.method, "How the travel was measured")->capture_default_str();
  sub->add_option("--reference-sigma-percent", o.sigma_percent,
                  "Sigma of the travel in % of it, in the place of the column sigma_m");
  sub->footer(kFooter);
  sub->callback([sub, options, &exit_code] { exit_code = run(*sub, *options); });
}

}  // namespace lsv::cli
