// SPDX-License-Identifier: BSD-3-Clause
// A CSV text with `#` comment lines, read by column name.
#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace lsv::test {

class CsvTable {
 public:
  explicit CsvTable(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#') continue;
      const std::vector<std::string> cells = split(line);
      if (columns_.empty()) {
        for (std::size_t i = 0; i < cells.size(); ++i) columns_[cells[i]] = i;
      } else {
        rows_.push_back(cells);
      }
    }
  }

  std::size_t rows() const { return rows_.size(); }
  /// Throws std::out_of_range for a row or column that is not there.
  const std::string& text(std::size_t row, const std::string& column) const {
    return rows_.at(row).at(columns_.at(column));
  }
  double number(std::size_t row, const std::string& column) const {
    return std::stod(text(row, column));
  }

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> out(1);
    for (const char c : line) {
      if (c == ',')
        out.emplace_back();
      else
        out.back() += c;
    }
    return out;
  }

  std::map<std::string, std::size_t> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace lsv::test
