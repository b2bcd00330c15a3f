// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/time_base.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lsv {
namespace {

constexpr double kMaxRate_hz = 1e9;  // faster than the resolution of a stamp
constexpr long double kMaxTime_ns = 0x1p62L;

Error usage(const char* what) { return {ErrorCode::invalid_argument, what}; }

}  // namespace

Result<TimeBase> TimeBase::make(const SourceOptions& options) {
  const bool has_table = !options.timestamps_path.empty();
  if (options.rate_hz && has_table)
    return usage("--rate-hz and --timestamps both give the time of the frames; give only one");
  if (!options.rate_hz && !has_table && options.need_time) {
    return usage(
        "the time between frames is not known and there is no default frame rate; give --rate-hz "
        "FRAMES_PER_SECOND or --timestamps FILE");
  }
  TimeBase base;
  if (options.rate_hz) {
    if (!(*options.rate_hz > 0.0 && *options.rate_hz <= kMaxRate_hz))
      return usage("--rate-hz must be above 0 and at most 1e9 frames per second");
    base.rate_hz_ = options.rate_hz;
  }
  if (has_table) {
    auto table = read_timestamps(options.timestamps_path);
    if (!table) return table.error();
    base.table_ = std::move(table).value();
    base.table_name_ = options.timestamps_path;
  }
  return base;
}

Result<std::optional<std::string>> TimeBase::check_length(std::int64_t frame_count,
                                                          std::int64_t last_index) const {
  if (!table_ || !table_->frames.empty()) return std::optional<std::string>();
  const auto rows = static_cast<std::int64_t>(table_->stamps.size());
  if (rows <= frame_count) return std::optional<std::string>();
  const std::string facts = table_name_ + ": holds " + std::to_string(rows) + " stamps for " +
                            std::to_string(frame_count) + " frames";
  if (last_index + 1 > frame_count) {
    return Error{ErrorCode::bad_input,
                 facts +
                     " of which some are missing; add a column `frame` (0 for the first file) "
                     "to say which stamp is whose"};
  }
  return std::optional(facts + "; the last " + std::to_string(rows - frame_count) +
                       " are not used.");
}

Result<Stamp> TimeBase::stamp(const FramePlace& place) const {
  if (table_) return from_table(place);
  if (rate_hz_) return from_rate(place.index);
  return Stamp{place.index};
}

Result<Stamp> TimeBase::from_rate(std::int64_t index) const {
  // From the index each time, never by adding periods, so that long runs do not drift.
  const long double ns = static_cast<long double>(index) * kNsPerS / *rate_hz_;
  if (ns > kMaxTime_ns) {
    return usage("--rate-hz is so low that a frame lies more than 146 years after the first");
  }
  return Stamp{static_cast<std::int64_t>(std::roundl(ns))};
}

Result<Stamp> TimeBase::from_table(const FramePlace& place) const {
  const auto missing = [&](std::int64_t number, const char* remedy) {
    return Error{ErrorCode::bad_input,
                 table_name_ + ": has no time stamp for frame " + std::to_string(number) + remedy};
  };
  if (table_->frames.empty()) {
    const auto row = static_cast<std::size_t>(place.ordinal);
    if (row >= table_->stamps.size())
      return missing(place.index, "; it needs one line for each frame that exists");
    return table_->stamps[row];
  }
  const auto& frames = table_->frames;
  const auto at = std::lower_bound(frames.begin(), frames.end(), place.index);
  if (at == frames.end() || *at != place.index)
    return missing(place.index, "; frames are numbered from 0 for the first file");
  return table_->stamps[static_cast<std::size_t>(at - frames.begin())];
}

}  // namespace lsv
