// SPDX-License-Identifier: BSD-3-Clause
// Whether a replay says bit for bit what was said live.
#pragma once

#include <cstdint>
#include <string>

#include "lsv/core/step_report.h"
#include "lsv/ingest/recording.h"

namespace lsv::cli {

class ReplayCheck {
 public:
  /// `replayed` is what the odometer says now about `recorded`. Frame after frame.
  void compare(const RecordedFrame& recorded, const StepReport& replayed);

  /// No step differs that could be compared.
  bool identical() const { return different_ == 0; }
  /// No step could be compared.
  bool compared_nothing() const { return compared_ == 0; }
  /// What came of it, as a sentence or two.
  std::string text() const;

 private:
  /// Why steps from this one on say nothing: a frame that the odometer had is not in the recording.
  std::string reason_to_stop(const RecordedFrame& recorded) const;

  std::uint32_t next_ordinal_ = 0;
  std::int64_t frames_ = 0;
  std::int64_t compared_ = 0;
  std::int64_t different_ = 0;
  std::string first_difference_;
  std::string stopped_because_;  // empty while every frame was there
};

}  // namespace lsv::cli
