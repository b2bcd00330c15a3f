// SPDX-License-Identifier: BSD-3-Clause
// Tables as one MCAP file, which Foxglove and PlotJuggler draw without set-up: a channel for each,
// a JSON object for each row with the names of the columns, in the order of time.
#pragma once

#include <string>
#include <vector>

#include "lsv/core/result.h"

namespace lsv::cli {

struct TopicTable {
  std::string topic;
  /// Lines that begin with # are left out; then a header that begins with time_s, then numbers,
  /// words, or nothing where a value is unknown (null in the file).
  std::string csv;
};

/// A new file. The time of a row is that of its message, in ns since the zero of time_s.
Result<void> write_tables_mcap(const std::string& path, const std::vector<TopicTable>& tables);

}  // namespace lsv::cli
