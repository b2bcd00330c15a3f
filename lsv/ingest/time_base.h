// SPDX-License-Identifier: BSD-3-Clause
// The stamp of each frame: from a constant frame rate, from a table of stamps, or, for
// inspection only, the index itself. There is no default rate. Immutable after make().
// Internal to lsv/: use frame_source.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "lsv/ingest/frame_source.h"
#include "lsv/ingest/timestamps.h"

namespace lsv {

/// One frame's place: `index` counts missing frames, `ordinal` only those that exist.
struct FramePlace {
  std::int64_t index = 0;
  std::int64_t ordinal = 0;
};

class TimeBase {
 public:
  static Result<TimeBase> make(const SourceOptions& options);

  /// A table without frame numbers has one row for each frame that exists. Called when the
  /// number of frames and the last index are known: a table that fits neither is an error, and
  /// a table that is longer gives a warning.
  Result<std::optional<std::string>> check_length(std::int64_t frame_count,
                                                  std::int64_t last_index) const;

  Result<Stamp> stamp(const FramePlace& place) const;

  bool is_time() const { return rate_hz_ || table_; }

 private:
  Result<Stamp> from_rate(std::int64_t index) const;
  Result<Stamp> from_table(const FramePlace& place) const;

  std::optional<double> rate_hz_;
  std::optional<TimestampTable> table_;
  std::string table_name_;
};

}  // namespace lsv
