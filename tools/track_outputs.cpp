// SPDX-License-Identifier: BSD-3-Clause
#include "tools/track_outputs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <utility>

#include "lsv/output/csv_sink.h"
#include "lsv/output/jsonl_sink.h"
#include "lsv/output/tum_sink.h"
#include "tools/commands.h"
#include "tools/output_names.h"

namespace lsv::cli {
namespace {

std::string config_path(const OutputPaths& paths) {
  return (std::filesystem::path(paths.directory) / "config.toml").string();
}

Result<void> make_directory(const OutputPaths& paths) {
  if (paths.directory.empty()) return {};
  std::error_code status;
  std::filesystem::create_directories(paths.directory, status);
  if (status) {
    return Error{ErrorCode::output_failed,
                 paths.directory + ": cannot be created: " + status.message()};
  }
  return {};
}

void fill_from_directory(OutputPaths& paths) {
  if (paths.directory.empty()) return;
  const std::filesystem::path directory = paths.directory;
  const auto fill = [&](std::string& path, const char* name) {
    if (path.empty()) path = (directory / name).string();
  };
  fill(paths.csv, "track.csv");
  fill(paths.tum, "track.tum");
  fill(paths.report, "report.html");
  fill(paths.summary, "summary.json");
}

std::vector<std::string> names(const OutputPaths& paths) {
  return {paths.csv, paths.tum, paths.jsonl, paths.report, paths.summary};
}

}  // namespace

void add_output_options(CLI::App& command, OutputPaths& paths) {
  const char* const group = "Outputs ('-' is standard output)";
  command
      .add_option("-o,--output", paths.directory,
                  "Folder for track.csv, track.tum, summary.json, report.html and config.toml")
      ->group(group);
  command.add_option("--csv", paths.csv, "One row per frame")->group(group);
  command.add_option("--tum", paths.tum, "Trajectory: t x y z qx qy qz qw")->group(group);
  command.add_option("--jsonl", paths.jsonl, "One JSON object per frame")->group(group);
  command.add_option("--report", paths.report, "HTML report that needs no network")->group(group);
  command.add_option("--summary", paths.summary, "Summary as JSON")->group(group);
  command
      .add_option("--report-frame", paths.report_frame,
                  "Later frame of the pair whose correlation plane the report shows [the first "
                  "accepted one]")
      ->group(group);
}

Result<void> refuse_empty_names(const CLI::App& command) {
  return refuse_empty_names(command,
                            {"--output", "--csv", "--tum", "--jsonl", "--report", "--summary"});
}

Result<void> check_output_names(OutputPaths paths, const std::vector<std::string>& others,
                                const std::vector<std::string>& inputs) {
  fill_from_directory(paths);
  std::vector<std::string> outputs = names(paths);
  outputs.insert(outputs.end(), others.begin(), others.end());
  if (!paths.directory.empty()) outputs.push_back(config_path(paths));
  if (Result<void> checked = at_most_one_on_stdout(outputs); !checked) return checked;
  if (Result<void> checked = refuse_inputs(outputs, inputs); !checked) return checked;
  return refuse_shared_files(outputs);
}

Result<TrackOutputs> TrackOutputs::open(OutputPaths paths, const RunInfo& info,
                                        const std::string& config_toml,
                                        const std::vector<std::string>& inputs,
                                        const std::vector<std::string>& others) {
  if (Result<void> checked = check_output_names(paths, others, inputs); !checked)
    return checked.error();
  if (Result<void> made = make_directory(paths); !made) return made.error();
  fill_from_directory(paths);

  TrackOutputs out;
  out.report_frame_ = paths.report_frame;
  out.engine_ = word(info.config.correlation.engine);
  using Make = std::function<std::unique_ptr<TrackSink>(OutputFile)>;
  const std::pair<std::string, Make> wanted[] = {
      {paths.csv, [&](OutputFile f) { return std::make_unique<CsvSink>(std::move(f), info); }},
      {paths.tum, [](OutputFile f) { return std::make_unique<TumSink>(std::move(f)); }},
      {paths.jsonl, [](OutputFile f) { return std::make_unique<JsonlSink>(std::move(f)); }},
      {paths.report,
       [&](OutputFile f) {
         auto report = std::make_unique<ReportBuilder>(std::move(f), info);
         out.report_ = report.get();
         return report;
       }},
  };
  for (const auto& [path, make] : wanted) {
    if (path.empty()) continue;
    Result<OutputFile> file = OutputFile::open(path);
    if (!file) return file.error();
    out.sinks_.push_back(make(std::move(file).value()));
  }

  std::optional<OutputFile> summary_file;
  if (!paths.summary.empty()) {
    Result<OutputFile> file = OutputFile::open(paths.summary);
    if (!file) return file.error();
    summary_file.emplace(std::move(file).value());
  }
  auto summary = std::make_unique<SummaryBuilder>(info, std::move(summary_file));
  out.summary_ = summary.get();
  out.sinks_.push_back(std::move(summary));

  if (!paths.directory.empty()) {
    Result<OutputFile> file = OutputFile::open(config_path(paths));
    if (!file) return file.error();
    out.config_.emplace(std::move(file).value());
    out.config_toml_ = config_toml;
  }
  return out;
}

Result<void> TrackOutputs::write(const StepReport& report, const FrameView& frame,
                                 Odometer& odometer) {
  if (Result<void> kept = keep_pair(report, frame, odometer); !kept) return kept;
  return write(report);
}

Result<void> TrackOutputs::write(const StepReport& report) {
  for (const auto& sink : sinks_) {
    if (Result<void> written = sink->write(report); !written) return written;
  }
  return {};
}

Result<void> TrackOutputs::keep_pair(const StepReport& report, const FrameView& frame,
                                     Odometer& odometer) {
  const bool correlated = !std::isnan(report.shift.quality.zncc);
  const bool wanted =
      report_frame_ ? report.frame == *report_frame_ : report.shift.status == ShiftStatus::ok;
  if (report_ == nullptr || pair_kept_ || !correlated || !wanted) return {};
  pair_kept_ = true;
  const CorrelationPlane& plane = odometer.plane();
  report_->set_preview(preview_of(frame));
  return report_->set_plane(
      {.frame = report.frame,
       .max_dx_px = plane.lags.max_dx_px,
       .max_dy_px = plane.lags.max_dy_px,
       .zncc = {plane.values.data(), plane.values.data() + plane.values.size()},
       .dx_px = report.shift.dx_px,
       .dy_px = report.shift.dy_px,
       .status = std::string(word(report.shift.status)),
       .engine = engine_});
}

Result<void> TrackOutputs::finish(const RunEnd& end) {
  for (const auto& sink : sinks_) {
    if (Result<void> finished = sink->finish(end); !finished) return finished;
  }
  if (config_) {
    if (Result<void> written = config_->write(config_toml_); !written) return written;
    if (Result<void> completed = config_->complete(); !completed) return completed;
  }
  for (const auto& sink : sinks_) {
    if (Result<void> committed = sink->commit(); !committed) return committed;
  }
  return config_ ? config_->commit() : Result<void>();
}

int exit_code_of(const Summary& summary, double max_rejected_share) {
  if (summary.interrupted) return kExitInterrupted;
  if (summary.shifts_ok > 0 && summary.rejected_share <= max_rejected_share) return kExitOk;
  const auto most_often =
      std::max_element(summary.rejected.begin(), summary.rejected.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  std::fprintf(
      stderr, "lsv: %lld of %lld shifts were refused (--max-rejected is %g), most often %s: %s\n",
      static_cast<long long>(summary.shifts_rejected),
      static_cast<long long>(summary.shifts_rejected + summary.shifts_ok), max_rejected_share,
      word(most_often->first).data(), advice(most_often->first).data());
  return kExitLowQuality;
}

}  // namespace lsv::cli
