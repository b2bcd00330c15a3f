// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <string_view>

#include "lsv/core/stamp.h"

namespace lsv {
namespace {

// DBL_MAX has 309 digits before the point, then sign, point and up to 17 decimals.
using NumberBuffer = std::array<char, 340>;

constexpr int kNsDigits = 9;

bool is_negative_zero(std::string_view text) {
  return text.starts_with('-') && text.find_first_not_of("-0.") == std::string_view::npos;
}

}  // namespace

void append_fixed(std::string& out, double value, int decimals) {
  if (!std::isfinite(value)) return;
  NumberBuffer buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::fixed, std::clamp(decimals, 0, 17))
                       .ptr;
  std::string_view text(buffer.data(), static_cast<std::size_t>(end - buffer.data()));
  if (is_negative_zero(text)) text.remove_prefix(1);
  out += text;
}

void append_shortest(std::string& out, double value) {
  if (!std::isfinite(value)) return;
  NumberBuffer buffer;
  out.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

void append_integer(std::string& out, std::int64_t value) {
  NumberBuffer buffer;
  out.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

void append_seconds(std::string& out, std::int64_t time_ns) {
  if (time_ns < 0) out += '-';
  // The quotient and remainder are small enough to negate even where time_ns itself is not.
  const std::int64_t whole_s = time_ns / kNsPerS;
  const std::int64_t rest_ns = time_ns % kNsPerS;
  append_integer(out, whole_s < 0 ? -whole_s : whole_s);
  out += '.';
  std::string digits;
  append_integer(digits, rest_ns < 0 ? -rest_ns : rest_ns);
  out.append(static_cast<std::size_t>(kNsDigits) - digits.size(), '0');
  out += digits;
}

std::string formatted(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  va_end(arguments);
  std::string out(static_cast<std::size_t>(std::max(length, 0)), '\0');
  std::vsnprintf(out.data(), out.size() + 1, format, again);
  va_end(again);
  return out;
}

}  // namespace lsv
