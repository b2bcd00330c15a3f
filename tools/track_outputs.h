// SPDX-License-Identifier: BSD-3-Clause
// The outputs that one `lsv track` writes: which were asked for, and handing every report to all
// of them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lsv/odometer.h"
#include "lsv/output/report.h"
#include "lsv/output/summary.h"
#include "lsv/output/track_sink.h"

namespace lsv::cli {

struct OutputPaths {
  std::string directory;  // -o: standard names inside it
  std::string csv;
  std::string tum;
  std::string jsonl;
  std::string report;
  std::string summary;
  std::optional<std::int64_t> report_frame;  // later frame of the pair shown in the report
};

void add_output_options(CLI::App& command, OutputPaths& paths);

/// An output option of `command` given an empty name, as by an unset shell variable, is an error.
Result<void> refuse_empty_names(const CLI::App& command);

/// Refuses (invalid_argument) outputs of which one is, by whatever name, one of `inputs` or of the
/// other outputs. `others`: files that the command writes besides `paths`.
Result<void> check_output_names(OutputPaths paths, const std::vector<std::string>& others,
                                const std::vector<std::string>& inputs);

class TrackOutputs {
 public:
  /// `config_toml`: the resolved settings, written beside the results of -o. Checks the names with
  /// check_output_names().
  static Result<TrackOutputs> open(OutputPaths paths, const RunInfo& info,
                                   const std::string& config_toml,
                                   const std::vector<std::string>& inputs,
                                   const std::vector<std::string>& others = {});

  /// `odometer` has just made `report` from `frame`.
  Result<void> write(const StepReport& report, const FrameView& frame, Odometer& odometer);
  /// Where the frame is gone: the report then shows no correlation plane.
  Result<void> write(const StepReport& report);
  Result<void> finish(const RunEnd& end);

  Summary summary() const { return summary_->summary(); }
  /// The pair chosen with --report-frame has not come.
  bool lacks_report_frame() const { return report_ != nullptr && report_frame_ && !pair_kept_; }

 private:
  Result<void> keep_pair(const StepReport& report, const FrameView& frame, Odometer& odometer);

  std::vector<std::unique_ptr<TrackSink>> sinks_;
  SummaryBuilder* summary_ = nullptr;  // one of sinks_
  ReportBuilder* report_ = nullptr;    // one of sinks_, or null
  std::optional<OutputFile> config_;
  std::string config_toml_;
  std::optional<std::int64_t> report_frame_;
  std::string engine_;
  bool pair_kept_ = false;
};

/// Of a run that came to its end or was interrupted; kExitLowQuality is explained on stderr.
int exit_code_of(const Summary& summary, double max_rejected_share);

}  // namespace lsv::cli
