// SPDX-License-Identifier: BSD-3-Clause
// A table of comma-separated text whose columns are found by name: what lsv writes, and what people
// write for it. Lines that start with '#' and empty lines are skipped; the first other line names
// the columns, each once; blanks around a cell do not count. UTF-8, with or without a byte order
// mark. No quotes: a cell holds no comma.
// Errors: bad_input, naming file, line and column.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lsv/core/result.h"

namespace lsv {

class CsvTable {
 public:
  /// Up to 4 GiB. "-" is not standard input here.
  static Result<CsvTable> read(const std::string& path);
  /// `name` stands for the file in messages.
  static Result<CsvTable> parse(std::string text, const std::string& name);

  std::size_t rows() const { return starts_.size(); }
  std::size_t columns() const { return columns_.size(); }
  bool has(std::string_view column) const;
  /// Where it stands; the error names the columns that are there.
  Result<std::size_t> column(std::string_view name) const;

  /// `row` < rows(), `column` from column(). Valid while the table lives.
  std::string_view text(std::size_t row, std::size_t column) const;
  /// NaN for an empty cell; an error for one that is not a finite number.
  Result<double> number(std::size_t row, std::size_t column) const;
  /// The same, where an empty cell is an error, too.
  Result<double> known_number(std::size_t row, std::size_t column) const;

  const std::string& name() const { return name_; }
  /// Everything that was read.
  std::string_view bytes() const { return text_; }
  /// For messages about a row.
  std::size_t line(std::size_t row) const { return lines_[row]; }

 private:
  Error cell_error(std::size_t row, std::size_t column, const std::string& why) const;

  std::string name_;
  std::string text_;
  std::vector<std::string> columns_;
  std::vector<std::size_t> starts_;  // of each row in text_
  std::vector<std::size_t> lines_;
};

}  // namespace lsv
