// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "lsv/ingest/timestamps.h"
#include "tests/fuzz/frame_checks.h"

namespace {

using lsv::fuzz::require;

void check_table(const lsv::TimestampTable& table) {
  require(!table.stamps.empty(), "a table is not empty");
  require(table.frames.empty() || table.frames.size() == table.stamps.size(),
          "every stamp has its frame");
  for (std::size_t i = 1; i < table.stamps.size(); ++i) {
    require(table.stamps[i] > table.stamps[i - 1], "stamps increase");
    require(lsv::seconds_between(table.stamps[i - 1], table.stamps[i]) > 0.0,
            "intervals are positive");
    require(table.frames.empty() || table.frames[i] > table.frames[i - 1], "frames increase");
  }
}

/// The exact parser against the rounding one of the C library.
void check_number(const std::string& text) {
  const auto ns = lsv::ns_from_decimal_seconds(text);
  if (!ns) return;
  const long double expected_ns = std::strtold(text.c_str(), nullptr) * 1e9L;
  require(std::fabs(static_cast<long double>(*ns) - expected_ns) <= 2.0L,
          "a number agrees with strtold");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  check_number(text);
  const auto table = lsv::parse_timestamps(text, "stamps.csv");
  if (table) {
    check_table(table.value());
  } else {
    require(table.error().message.find("stamps.csv") != std::string::npos,
            "an error names the file");
  }
  return 0;
}
