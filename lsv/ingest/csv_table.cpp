// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/csv_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "lsv/ingest/option_text.h"

namespace lsv {
namespace {

constexpr std::uintmax_t kMaxFile_bytes = std::uintmax_t{4} << 30;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// What some programs put before UTF-8.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::size_t cells_in(std::string_view line) {
  return static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
}

/// A name that stands for two columns; null without one. Columns without a name may be many.
const std::string* repeated(const std::vector<std::string>& columns) {
  for (auto column = columns.begin(); column != columns.end(); ++column) {
    if (!column->empty() && std::find(columns.begin(), column, *column) != column) return &*column;
  }
  return nullptr;
}

}  // namespace

Result<CsvTable> CsvTable::read(const std::string& path) {
  std::error_code status;
  if (std::filesystem::is_directory(path, status))
    return Error{ErrorCode::bad_input, path + ": is a folder, not a file"};
  if (!std::filesystem::is_regular_file(path, status))
    return Error{ErrorCode::bad_input, path + ": there is no such file"};
  const std::uintmax_t size_bytes = std::filesystem::file_size(path, status);
  if (status || size_bytes > kMaxFile_bytes)
    return Error{ErrorCode::bad_input, path + ": larger than 4 GiB"};
  std::string text(size_bytes, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(text.data(), static_cast<std::streamsize>(size_bytes)))
    return Error{ErrorCode::bad_input, path + ": cannot be read"};
  return parse(std::move(text), path);
}

Result<CsvTable> CsvTable::parse(std::string text, const std::string& name) {
  CsvTable out;
  out.name_ = name;
  out.text_ = std::move(text);
  const std::string_view all = out.text_;
  std::size_t line_number = 0;
  for (std::size_t start = all.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
       start < all.size();) {
    const std::size_t end = std::min(all.find('\n', start), all.size());
    const std::string_view line = trimmed(all.substr(start, end - start));
    ++line_number;
    if (!line.empty() && line.front() != '#') {
      if (out.columns_.empty()) {
        for (const std::string_view cell : split_at(line, ','))
          out.columns_.emplace_back(trimmed(cell));
        if (const std::string* const twice = repeated(out.columns_)) {
          return Error{ErrorCode::bad_input, name + ":" + std::to_string(line_number) +
                                                 ": the column " + *twice + " is there twice"};
        }
      } else if (cells_in(line) != out.columns_.size()) {
        return Error{ErrorCode::bad_input, name + ":" + std::to_string(line_number) + ": " +
                                               std::to_string(cells_in(line)) + " cells under " +
                                               std::to_string(out.columns_.size()) + " columns"};
      } else {
        out.starts_.push_back(start);
        out.lines_.push_back(line_number);
      }
    }
    start = end + 1;
  }
  if (out.columns_.empty())
    return Error{ErrorCode::bad_input, name + ": no line that names the columns"};
  return out;
}

bool CsvTable::has(std::string_view column) const {
  return std::ranges::find(columns_, column) != columns_.end();
}

Result<std::size_t> CsvTable::column(std::string_view name) const {
  const auto found = std::ranges::find(columns_, name);
  if (found != columns_.end()) return static_cast<std::size_t>(found - columns_.begin());
  std::string there;
  for (const std::string& column : columns_) there += (there.empty() ? "" : ", ") + column;
  return Error{ErrorCode::bad_input,
               name_ + ": no column " + std::string(name) + "; there are " + there};
}

std::string_view CsvTable::text(std::size_t row, std::size_t column) const {
  const std::string_view all = text_;
  std::size_t start = starts_[row];
  const std::size_t line_end = std::min(all.find('\n', start), all.size());
  for (; column > 0; --column) start = all.find(',', start) + 1;
  const std::size_t end = std::min(all.find(',', start), line_end);
  return trimmed(all.substr(start, end - start));
}

Error CsvTable::cell_error(std::size_t row, std::size_t column, const std::string& why) const {
  return {ErrorCode::bad_input,
          name_ + ":" + std::to_string(lines_[row]) + ": " + columns_[column] + " " + why};
}

Result<double> CsvTable::number(std::size_t row, std::size_t column) const {
  std::string_view cell = text(row, column);
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (cell.front() == '+') cell.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    return cell_error(row, column, "is \"" + std::string(text(row, column)) + "\", not a number");
  return value;
}

Result<double> CsvTable::known_number(std::size_t row, std::size_t column) const {
  if (text(row, column).empty()) return cell_error(row, column, "is empty");
  return number(row, column);
}

}  // namespace lsv
