// SPDX-License-Identifier: BSD-3-Clause
// What `lsv fuse` writes into a folder: pose.csv, pose.tum, pose.jsonl and events.csv row by row,
// report.html and summary.json at the end. All get their names together, when all are complete.
// Formats: docs/formats.md.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lsv/output/output_file.h"
#include "tools/fuse_run.h"

namespace lsv::cli {

/// Names of the files in a folder, for the checks before anything is opened.
inline constexpr std::array kFuseFiles = {"pose.csv",   "pose.tum",     "pose.jsonl",
                                          "events.csv", "summary.json", "report.html"};

class FuseOutputs {
 public:
  /// `head`: lines that begin with #, for the CSV files.
  static Result<FuseOutputs> open(const std::string& folder, const std::string& head,
                                  const FusionConfig& config);

  Result<void> write(const FuseRow& row);
  Result<void> finish(std::string_view summary_json, std::string_view report_html);

  std::size_t events() const { return events_; }

 private:
  enum File : std::size_t { csv, tum, jsonl, events_csv, summary, report };  // as kFuseFiles

  FuseOutputs(std::vector<OutputFile> files, const FusionConfig& config);
  Result<void> write_events(const NavState& state);
  Result<void> event(Stamp stamp, std::string_view what, std::string_view detail);

  std::vector<OutputFile> files_;
  std::vector<std::string> sensor_names_;
  bool has_wheels_ = false;
  NavStatus last_status_ = NavStatus::not_started;
  bool left_slipped_ = false;
  bool right_slipped_ = false;
  HeadingSource last_heading_ = HeadingSource::nothing;
  std::size_t events_ = 0;
  std::string text_;
};

}  // namespace lsv::cli
