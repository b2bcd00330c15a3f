// SPDX-License-Identifier: BSD-3-Clause
// The settings of a run as one list of named values: the source of the CSV comment lines, of
// "settings" in the JSON outputs and of the table in the report, so that a result can be re-run
// from any of them. Names carry their unit as in the code.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "lsv/output/track_sink.h"

namespace lsv {

struct Setting {
  std::string_view key;
  std::variant<std::string, double, std::int64_t, bool> value;  // double: NaN where unknown
};

std::vector<Setting> run_settings(const RunInfo& info);

/// The value on one line: control characters become '?', an unknown number is "unknown".
std::string value_text(const Setting& setting);

inline constexpr std::string_view kUnits =
    "time s, shift px, velocity m/s, position m; sigma is one standard deviation";
inline constexpr std::string_view kSignConvention =
    "positive dx: the pattern moved to a larger column; positive dy: to a larger row; x and y are "
    "sensor axes along image columns and rows";

}  // namespace lsv
