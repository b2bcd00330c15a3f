// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "lsv/ingest/csv_table.h"
#include "tests/fuzz/frame_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using lsv::fuzz::require;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto table = lsv::CsvTable::parse(text, "t.csv");
  if (!table) {
    require(table.error().message.find("t.csv") != std::string::npos, "an error names the file");
    return 0;
  }
  const std::size_t columns = table.value().columns();
  require(columns > 0, "a table has columns");
  for (std::size_t row = 0; row < table.value().rows(); ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const std::string_view cell = table.value().text(row, column);
      require(cell.find_first_of(",\n") == std::string_view::npos, "a cell ends where it ends");
      const auto number = table.value().number(row, column);
      require(!number || cell.empty() == std::isnan(number.value()),
              "only an empty cell is unknown");
    }
  }
  return 0;
}
