// SPDX-License-Identifier: BSD-3-Clause
// What `lsv fuse` writes row by row: pose.csv, pose.tum, pose.jsonl and events.csv of a folder.
// Formats: docs/formats.md.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lsv/output/output_file.h"
#include "tools/fuse_run.h"

namespace lsv::cli {

class FuseOutputs {
 public:
  /// `head`: lines that begin with #, for the CSV files.
  static Result<FuseOutputs> open(const std::string& folder, const std::string& head,
                                  const FusionConfig& config);

  Result<void> write(const FuseRow& row);
  Result<void> commit();

  std::size_t events() const { return events_; }

 private:
  FuseOutputs(OutputFile csv, OutputFile tum, OutputFile jsonl, OutputFile events,
              const FusionConfig& config);
  Result<void> write_events(const NavState& state);
  Result<void> event(Stamp stamp, std::string_view what, std::string_view detail);

  OutputFile csv_;
  OutputFile tum_;
  OutputFile jsonl_;
  OutputFile events_file_;
  std::vector<std::string> sensor_names_;
  NavStatus last_status_ = NavStatus::not_started;
  bool left_slipped_ = false;
  bool right_slipped_ = false;
  HeadingSource last_heading_ = HeadingSource::nothing;
  std::size_t events_ = 0;
  std::string text_;
};

/// Names of the files in a folder, for the checks before anything is opened.
inline constexpr std::array kFuseFiles = {"pose.csv",   "pose.tum",     "pose.jsonl",
                                          "events.csv", "summary.json", "report.html"};

}  // namespace lsv::cli
