// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay_check.h"

namespace lsv::cli {

std::string ReplayCheck::reason_to_stop(const RecordedFrame& recorded) const {
  const std::string index = std::to_string(recorded.frame.index);
  if (!recorded.step) return "what was said about frame " + index + " is not in the recording";
  const bool began_live = recorded.step->shift.status == ShiftStatus::first_frame;
  if (frames_ == 0 && !began_live) return "the recording begins in the middle of a run";
  if (recorded.ordinal != next_ordinal_)
    return "frames before frame " + index + " were measured but are not in the recording";
  return {};
}

void ReplayCheck::compare(const RecordedFrame& recorded, const StepReport& replayed) {
  if (stopped_because_.empty()) stopped_because_ = reason_to_stop(recorded);
  next_ordinal_ = recorded.ordinal + 1;
  ++frames_;
  if (!stopped_because_.empty()) return;
  ++compared_;
  const std::string difference = mcap::first_difference(*recorded.step, replayed);
  if (difference.empty()) return;
  if (different_++ == 0)
    first_difference_ = "frame " + std::to_string(recorded.frame.index) + ", " + difference;
}

std::string ReplayCheck::text() const {
  if (compared_nothing()) return "no step can be compared, because " + stopped_because_;
  std::string out = different_ == 0
                        ? std::to_string(compared_) + " steps are bit for bit as recorded"
                        : std::to_string(different_) + " of " + std::to_string(compared_) +
                              " steps are not as recorded, first: " + first_difference_;
  if (!stopped_because_.empty()) {
    out += "; " + std::to_string(frames_ - compared_) + " more cannot be compared, because " +
           stopped_because_;
  }
  return out;
}

}  // namespace lsv::cli
