// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/timestamps.h"

#include <algorithm>

#include "lsv/ingest/input_file.h"
#include "lsv/ingest/option_text.h"

namespace lsv {
namespace {

constexpr std::int64_t kMaxTime_ns = std::int64_t{1} << 62;
constexpr std::int64_t kMaxFile_bytes = std::int64_t{256} << 20;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  auto fields = split_at(line, ',');
  for (std::string_view& field : fields) field = trimmed(field);
  return fields;
}

/// An unsigned decimal number as its digits and the place of the point after `point` of them.
struct Decimal {
  std::string digits;
  std::int64_t point = 0;
};

std::optional<std::int64_t> exponent_of(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  constexpr int kMaxExponent = 10'000;
  const auto exponent = whole_number<int>(text);
  if (!exponent || *exponent > kMaxExponent || *exponent < -kMaxExponent) return std::nullopt;
  return *exponent;
}

std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal out;
  if (const std::size_t e = text.find_first_of("eE"); e != std::string_view::npos) {
    const auto exponent = exponent_of(text.substr(e + 1));
    if (!exponent) return std::nullopt;
    out.point = *exponent;
    text = text.substr(0, e);
  }
  const std::size_t dot = std::min(text.find('.'), text.size());
  out.digits = text.substr(0, dot);
  if (dot < text.size()) out.digits += text.substr(dot + 1);
  if (out.digits.empty() || !std::all_of(out.digits.begin(), out.digits.end(), is_digit))
    return std::nullopt;
  out.point += static_cast<std::int64_t>(dot);
  return out;
}

/// The whole part, rounded half up; nothing above kMaxTime_ns.
std::optional<std::int64_t> rounded(const Decimal& number) {
  const auto size = static_cast<std::int64_t>(number.digits.size());
  const auto digit_at = [&](std::int64_t place) {
    return place >= 0 && place < size ? number.digits[static_cast<std::size_t>(place)] - '0' : 0;
  };
  std::int64_t value = 0;
  for (std::int64_t place = 0; place < number.point; ++place) {
    value = value * 10 + digit_at(place);
    if (value > kMaxTime_ns / 10 && place + 1 < number.point) return std::nullopt;
    if (value == 0 && place >= size) break;
  }
  if (digit_at(number.point) >= 5) ++value;
  if (value > kMaxTime_ns) return std::nullopt;
  return value;
}

struct Columns {
  std::size_t count = 0;
  std::size_t time = 0;
  bool time_is_ns = false;
  std::optional<std::size_t> frame;
};

/// Reads line by line; each error is prefixed with the place.
class TableParser {
 public:
  explicit TableParser(const std::string& name) : name_(name) {}

  Result<void> take(std::string_view line) {
    ++line_number_;
    if (line_number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    line = trimmed(line);
    if (line.empty() || line.front() == '#') return {};
    return columns_ ? take_row(line) : take_header(line);
  }

  Result<TimestampTable> finish() && {
    if (!columns_) {
      return Error{ErrorCode::bad_input,
                   name_ + ": has no header; its first line must name a column time_s or time_ns"};
    }
    if (table_.stamps.empty())
      return Error{ErrorCode::bad_input, name_ + ": holds no time stamp below its header"};
    return std::move(table_);
  }

 private:
  Error error_here(const std::string& what) const {
    return {ErrorCode::bad_input, name_ + ", line " + std::to_string(line_number_) + ": " + what};
  }

  Error error_in(const char* column, std::string_view field, const char* rule) const {
    constexpr std::size_t kShown = 40;
    return error_here(std::string("column ") + column + ": \"" +
                      std::string(field.substr(0, kShown)) + "\" " + rule);
  }

  const char* time_column() const { return columns_->time_is_ns ? "time_ns" : "time_s"; }

  Result<void> take_header(std::string_view line) {
    const auto names = fields_of(line);
    const auto place = [&](std::string_view wanted) -> std::optional<std::size_t> {
      const auto at = std::find(names.begin(), names.end(), wanted);
      if (at == names.end()) return std::nullopt;
      return static_cast<std::size_t>(at - names.begin());
    };
    for (const std::string_view once : {"time_s", "time_ns", "frame"}) {
      if (std::count(names.begin(), names.end(), once) > 1)
        return error_here("the header names the column " + std::string(once) + " twice");
    }
    const auto seconds = place("time_s");
    const auto nanoseconds = place("time_ns");
    if (!seconds && !nanoseconds)
      return error_here("the header names no column time_s or time_ns; separate columns by commas");
    if (seconds && nanoseconds)
      return error_here("the header names both time_s and time_ns; leave one out");
    columns_ = Columns{.count = names.size(),
                       .time = seconds ? *seconds : *nanoseconds,
                       .time_is_ns = nanoseconds.has_value(),
                       .frame = place("frame")};
    return {};
  }

  Result<void> take_row(std::string_view line) {
    const auto fields = fields_of(line);
    if (fields.size() != columns_->count) {
      return error_here("has " + std::to_string(fields.size()) + " columns where the header has " +
                        std::to_string(columns_->count));
    }
    auto time = take_time(fields[columns_->time]);
    if (!time || !columns_->frame) return time;
    return take_frame(fields[*columns_->frame]);
  }

  Result<void> take_time(std::string_view field) {
    const auto ns =
        columns_->time_is_ns ? whole_number<std::int64_t>(field) : ns_from_decimal_seconds(field);
    if (!ns || *ns > kMaxTime_ns || *ns < -kMaxTime_ns) {
      return error_in(time_column(), field,
                      columns_->time_is_ns ? "is not a whole number of ns within 146 years of zero"
                                           : "is not a decimal number of s within 146 years of "
                                             "zero");
    }
    if (!table_.stamps.empty() && *ns <= table_.stamps.back().ns)
      return error_in(time_column(), field, "is not later than the stamp before it");
    table_.stamps.push_back({*ns});
    return {};
  }

  Result<void> take_frame(std::string_view field) {
    const auto frame = whole_number<std::int64_t>(field);
    if (!frame || *frame < 0) return error_in("frame", field, "is not a whole number >= 0");
    if (!table_.frames.empty() && *frame <= table_.frames.back())
      return error_in("frame", field, "is not above the frame before it");
    table_.frames.push_back(*frame);
    return {};
  }

  const std::string& name_;
  std::int64_t line_number_ = 0;
  std::optional<Columns> columns_;
  TimestampTable table_;
};

}  // namespace

std::optional<std::int64_t> ns_from_decimal_seconds(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  auto seconds = parse_decimal(text);
  if (!seconds) return std::nullopt;
  seconds->point += 9;
  const auto ns = rounded(*seconds);
  if (!ns) return std::nullopt;
  return negative ? -*ns : *ns;
}

Result<TimestampTable> parse_timestamps(std::string_view text, const std::string& name) {
  TableParser parser(name);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const auto taken = parser.take(text.substr(0, end));
    if (!taken) return taken.error();
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return std::move(parser).finish();
}

Result<TimestampTable> read_timestamps(const std::string& path) {
  std::vector<std::uint8_t> bytes;
  const auto loaded = read_regular_file(path, kMaxFile_bytes, bytes);
  if (!loaded) return loaded.error();
  return parse_timestamps({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
}

}  // namespace lsv
