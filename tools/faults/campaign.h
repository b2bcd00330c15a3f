// SPDX-License-Identifier: BSD-3-Clause
// Runs scenarios: footage with its truth -> fault -> the real stream, in virtual time -> checker;
// and judges what was found.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lsv/core/config.h"
#include "lsv/core/result.h"
#include "tools/faults/checker.h"
#include "tools/faults/footage.h"
#include "tools/faults/scenario.h"

namespace lsv::faults {

/// A detector taken out on purpose: the campaign must notice. Otherwise it proves nothing.
enum class Broken {
  nothing,
  loss_by_stamps,  // ids and stamps say that all is contiguous
  duplicate_ids,   // every frame has an id of its own
  order,           // late frames have new ids and stamps
  stamp_check,     // wrong stamps look plausible
  format_check,    // the frame is cut to the right format
  frozen_check,
  light_check,       // dark and contrast
  row_check,         // rows that do not move as one
  correlation_gate,  // ZNCC, Q, peak ratio
  covariance,        // sigmas a tenth of what they are
  silence,           // a lost source is told after 10 s
  drop_oldest,       // a queue without end
};

struct CampaignOptions {
  int side_px = 128;
  std::int64_t exposures = 4000;
  int seeds = 5;
  std::uint64_t first_seed = 1;
  Preset preset = Preset::precise;
  bool learn_fixed_pattern = true;
  Broken broken = Broken::nothing;
};

/// One scenario over all seeds.
struct Row {
  std::string id;
  std::string fault;
  bool detects = false;  // there is something to tell
  Findings all{};        // counts added up, errors the largest; health and path of the last seed
  double detected_ratio = kUnknown;
  double latency_median_ms = kUnknown;
  double latency_p99_ms = kUnknown;
  double recovery_max_frames = kUnknown;
  double false_alarms_per_h = kUnknown;      // where alarms are not what the fault is about
  std::vector<std::string> broken_limits{};  // each with the seed that shows it
};

Result<Row> run_scenario(const Scenario& scenario, Scenes& scenes, const CampaignOptions& options);

/// All of them, or those whose id begins with one of `ids`.
std::vector<Scenario> chosen_scenarios(const std::vector<std::string>& ids);

}  // namespace lsv::faults
