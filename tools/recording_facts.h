// SPDX-License-Identifier: BSD-3-Clause
// What lsv info says about a recording, besides its frames.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "lsv/core/result.h"
#include "lsv/core/stamp.h"
#include "lsv/ingest/recording.h"

namespace lsv::cli {

struct RecordingFacts {
  RecordingNotes notes{};
  mcap::FileCondition condition{};
  bool has_tail = false;  // beside it
  std::int64_t frames = 0;
  std::optional<Stamp> first_stamp{};
  std::optional<Stamp> last_stamp{};
  std::int64_t missing = 0;   // exposures that never arrived
  std::int64_t dropped = 0;   // by the image queue
  std::int64_t rejected = 0;  // before the odometer
};

/// Reads the whole recording and what is sound of a damaged one.
Result<RecordingFacts> recording_facts(const std::string& path, std::int64_t max_pixels);

void print_text(const RecordingFacts& facts);
nlohmann::ordered_json to_json(const RecordingFacts& facts);

}  // namespace lsv::cli
