// SPDX-License-Identifier: BSD-3-Clause
// Time stamps of frames from a text table (docs/formats.md): a header names the columns, `time_s`
// (decimal seconds) or `time_ns` (whole nanoseconds) gives the stamp and the optional `frame` the
// index of the frame. Decimal text becomes int64 nanoseconds without passing through a double;
// digits beyond the ninth decimal are rounded to nearest. Stamps increase strictly and stay
// within +-2^62 ns (146 years), so that a difference of two never overflows. Errors name file,
// line and column. Pure functions: any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lsv/core/result.h"
#include "lsv/core/stamp.h"

namespace lsv {

struct TimestampTable {
  std::vector<Stamp> stamps;
  std::vector<std::int64_t> frames;  // of the same length, or empty without a `frame` column
};

Result<TimestampTable> read_timestamps(const std::string& path);

/// `name` stands for the file in errors.
Result<TimestampTable> parse_timestamps(std::string_view text, const std::string& name);

/// "12.5", "-0.000000001", "1.5e-3" in seconds to the nearest ns; nothing when it is not a
/// decimal number or is out of range.
std::optional<std::int64_t> ns_from_decimal_seconds(std::string_view text);

}  // namespace lsv
