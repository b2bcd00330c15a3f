// SPDX-License-Identifier: BSD-3-Clause
// Strict numbers in option texts: digits only, nothing before or after, no overflow.
// Internal to lsv/.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <vector>

namespace lsv {

inline std::vector<std::string_view> split_at(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

/// Empty unless `text` is a whole decimal number of type Number; "+1" and " 1" are refused.
template <typename Number>
std::optional<Number> whole_number(std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stopped_at, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stopped_at != end) return std::nullopt;
  return value;
}

}  // namespace lsv
