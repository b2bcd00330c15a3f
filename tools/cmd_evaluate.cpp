// SPDX-License-Identifier: BSD-3-Clause
// `lsv evaluate`: how good an estimated trajectory is.
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calibration/sha256.h"
#include "lsv/ingest/option_text.h"
#include "lsv/output/output_file.h"
#include "tools/commands.h"
#include "tools/evaluation_page.h"
#include "tools/evaluation_report.h"
#include "tools/output_names.h"

namespace lsv::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter =
    "EST and TRUTH are trajectories: CSV with time_s,x_m,y_m and optionally yaw_rad and the\n"
    "covariance (pose.csv of lsv fuse, truth.csv of lsv simulate rover, a track of lsv track), "
    "TUM\n"
    "(t x y z qx qy qz qw) or KITTI (12 numbers a line, no time). The extension tells which; a "
    ".txt\n"
    "is told by its columns. Poses belong together by their stamps, nearest within --max-dt-s; by\n"
    "order where a file has no time.\n"
    "The alignment decides what the figures mean and is always told. none: the estimate as it is,\n"
    "as it counts for a rover whose start is known; origin: first poses made equal; se2: best "
    "turn\n"
    "and shift in the plane; se3: in space; sim3: with a scale, which hides its error.\n"
    "Formulas and signs: docs/evaluation.md.\n"
    "\n"
    "Example, without hardware:\n"
    "  lsv simulate rover sand_crossing -o drive\n"
    "  lsv fuse --lsv drive/lsv_1.csv --lsv drive/lsv_2.csv --wheels drive/wheels.csv \\\n"
    "      --rover drive/rover.toml -o out\n"
    "  lsv evaluate out/pose.csv drive/truth.csv -o out\n"
    "Exit codes: 0 ok, 1 output not written, 2 usage, 3 input.";

struct EvaluateCommand {
  std::string estimate;
  std::string truth;
  std::string format_estimate;
  std::string format_truth;
  std::string align = std::string(word(EvaluationOptions{}.align));
  std::string segments_m;
  std::string json_path;
  std::string folder;
  EvaluationOptions options;
};

Error usage(std::string sentence) { return {ErrorCode::invalid_argument, std::move(sentence)}; }

Result<void> take_segments(const std::string& text, std::vector<double>& out) {
  if (text.empty()) return {};
  for (const std::string_view part : split_at(text, ',')) {
    const auto length_m = whole_number<double>(part);
    if (!length_m || !(*length_m > 0.0 && std::isfinite(*length_m)))
      return usage("--segments-m is \"" + text + "\" but must be lengths above 0, such as 1,2,5");
    out.push_back(*length_m);
  }
  return {};
}

Result<EvaluationOptions> options_of(const EvaluateCommand& command) {
  EvaluationOptions out = command.options;
  const auto kind = alignment_kind(command.align);
  if (!kind)
    return usage("--align is \"" + command.align + "\" but must be none, origin, se2, se3 or sim3");
  out.align = *kind;
  constexpr double kLongest = 1e9;
  const struct {
    const char* name;
    double value;
  } lengths[] = {{"--rpe-m", out.rpe_m}, {"--rpe-s", out.rpe_s}};
  for (const auto& [name, value] : lengths) {
    if (!(value > 0.0 && value <= kLongest))
      return usage(std::string(name) + " must be above 0 and at most 1e9");
  }
  if (!(out.association.max_dt_s >= 0.0 && out.association.max_dt_s <= 1e6))
    return usage("--max-dt-s must be from 0 to 1e6");
  if (!(std::abs(out.association.offset_s) <= 4e9)) return usage("--offset-s must be within 4e9");
  if (Result<void> taken = take_segments(command.segments_m, out.segments_m); !taken)
    return taken.error();
  return out;
}

Result<TrajectoryFormat> format_of(const std::string& path, const std::string& text,
                                   const char* option, const std::string& given) {
  if (given.empty()) {
    Result<TrajectoryFormat> found = trajectory_format(path, text);
    if (found) return found;
    return Error{found.error().code, found.error().message + "; " + option + " says what it is"};
  }
  for (const TrajectoryFormat format :
       {TrajectoryFormat::csv, TrajectoryFormat::tum, TrajectoryFormat::kitti}) {
    if (word(format) == given) return format;
  }
  return usage(std::string(option) + " is \"" + given + "\" but must be csv, tum or kitti");
}

Result<EvaluatedFile> read_input(const std::string& path, const char* option,
                                 const std::string& given_format) {
  Result<std::string> text = read_trajectory_text(path);
  if (!text) return text.error();
  const Result<TrajectoryFormat> format = format_of(path, text.value(), option, given_format);
  if (!format) return format.error();
  EvaluatedFile out{.path = path, .sha256 = sha256_hex(text.value()), .file = {}};
  Result<TrajectoryFile> file = parse_trajectory(std::move(text).value(), path, format.value());
  if (!file) return file.error();
  out.file = std::move(file).value();
  return out;
}

Result<EvaluationReport> report_of(const CLI::App& app, const EvaluateCommand& command) {
  Result<EvaluationOptions> options = options_of(command);
  if (!options) return options.error();
  Result<EvaluatedFile> estimate =
      read_input(command.estimate, "--format-est", command.format_estimate);
  if (!estimate) return estimate.error();
  Result<EvaluatedFile> truth = read_input(command.truth, "--format-truth", command.format_truth);
  if (!truth) return truth.error();
  const Trajectory& from = estimate.value().file.trajectory;
  const Trajectory& to = truth.value().file.trajectory;
  if (!(from.has_time && to.has_time) && app.count("--offset-s") + app.count("--max-dt-s") > 0)
    return usage("--offset-s and --max-dt-s need time in both files, and KITTI has none");
  Result<TrajectoryEvaluation> result = evaluate(from, to, options.value());
  if (!result) {
    return Error{result.error().code,
                 command.estimate + " and " + command.truth + ": " + result.error().message};
  }
  return EvaluationReport{.estimate = std::move(estimate).value(),
                          .truth = std::move(truth).value(),
                          .options = std::move(options).value(),
                          .result = std::move(result).value()};
}

/// evaluation.json and evaluation.html, where a folder was asked for.
std::vector<std::string> files_of(const EvaluateCommand& command) {
  if (command.folder.empty()) return {};
  return {(fs::path(command.folder) / "evaluation.json").string(),
          (fs::path(command.folder) / "evaluation.html").string()};
}

Result<void> check_outputs(const EvaluateCommand& command) {
  std::vector<std::string> outputs = files_of(command);
  outputs.push_back(command.json_path);
  return refuse_inputs(outputs, {command.estimate, command.truth});
}

Result<void> write_outputs(const EvaluateCommand& command, const EvaluationReport& report) {
  const std::string json = evaluation_json(report);
  if (const std::vector<std::string> files = files_of(command); !files.empty()) {
    std::error_code status;
    fs::create_directories(command.folder, status);
    if (status) {
      return Error{ErrorCode::output_failed,
                   command.folder + ": cannot be created: " + status.message()};
    }
    if (Result<void> done = write_file(files[0], json); !done) return done;
    if (Result<void> done = write_file(files[1], evaluation_html(report)); !done) return done;
  }
  if (!command.json_path.empty()) {
    if (Result<void> done = write_file(command.json_path, json); !done) return done;
  }
  if (command.json_path == "-") return {};
  return write_file("-", evaluation_text(report));
}

int run(const CLI::App& app, const EvaluateCommand& command) {
  if (Result<void> named = refuse_empty_names(app, {"--output", "--json"}); !named)
    return report_error(named.error());
  if (Result<void> fine = check_outputs(command); !fine) return report_error(fine.error());
  const Result<EvaluationReport> report = report_of(app, command);
  if (!report) return report_error(report.error());
  const Result<void> written = write_outputs(command, report.value());
  return written ? kExitOk : report_error(written.error());
}

}  // namespace

void add_evaluate_command(CLI::App& app, int& exit_code) {
  CLI::App* const sub =
      app.add_subcommand("evaluate",
                         "Errors of a trajectory against the truth: ATE, RPE, drift, "
                         "heading, NEES");
  const auto command = std::make_shared<EvaluateCommand>();
  EvaluateCommand& c = *command;
  sub->add_option("EST", c.estimate, "Trajectory to be judged (.csv, .tum, .kitti, .txt)")
      ->required();
  sub->add_option("TRUTH", c.truth, "Trajectory that counts as true")->required();
  sub->add_option("--align", c.align, "none, origin, se2, se3 or sim3")->capture_default_str();
  sub->add_option("--max-dt-s", c.options.association.max_dt_s,
                  "Largest difference of the stamps of a pair")
      ->capture_default_str();
  sub->add_option("--offset-s", c.options.association.offset_s, "Added to the times of EST")
      ->capture_default_str();
  sub->add_option("--rpe-m", c.options.rpe_m, "Length of the segments of RPE, m")
      ->capture_default_str();
  sub->add_option("--rpe-s", c.options.rpe_s, "Duration of the segments of RPE, s")
      ->capture_default_str();
  sub->add_option("--segments-m", c.segments_m,
                  "Lengths of the drift, such as 1,2,5; default: 10, 20, ... 80 % of the distance");
  sub->add_option("--format-est", c.format_estimate, "csv, tum or kitti; default: by the name");
  sub->add_option("--format-truth", c.format_truth, "csv, tum or kitti; default: by the name");
  sub->add_option("--json", c.json_path,
                  "Also write the figures as JSON; - for only that, on standard output");
  sub->add_option("-o,--output", c.folder, "Folder for evaluation.json and evaluation.html");
  sub->footer(kFooter);
  sub->callback([sub, command, &exit_code] { exit_code = run(*sub, *command); });
}

}  // namespace lsv::cli
