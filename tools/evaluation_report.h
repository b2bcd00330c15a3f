// SPDX-License-Identifier: BSD-3-Clause
// What `lsv evaluate` says: a table for the terminal and JSON for programs; the page is
// evaluation_page.h.
#pragma once

#include <string>
#include <vector>

#include "fusion/evaluation.h"
#include "lsv/ingest/trajectory_file.h"

namespace lsv::cli {

struct EvaluatedFile {
  std::string path;
  std::string sha256;
  TrajectoryFile file;
};

struct EvaluationReport {
  EvaluatedFile estimate;
  EvaluatedFile truth;
  EvaluationOptions options;
  TrajectoryEvaluation result;
};

/// One line each: what a user must know before trusting the figures.
std::vector<std::string> evaluation_warnings(const EvaluationReport& report);

/// The transform in words: "turn +1.20 deg, shift ...".
std::string alignment_text(const EvaluationReport& report);

std::string evaluation_text(const EvaluationReport& report);
std::string evaluation_json(const EvaluationReport& report);

}  // namespace lsv::cli
