// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/numbered_names.h"

#include <algorithm>
#include <charconv>
#include <compare>
#include <filesystem>
#include <string_view>

namespace lsv {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A maximal run of digits or of anything else.
std::string_view leading_run(std::string_view text) {
  const bool digits = is_digit(text.front());
  const auto end =
      std::find_if(text.begin(), text.end(), [&](char c) { return is_digit(c) != digits; });
  return text.substr(0, static_cast<std::size_t>(end - text.begin()));
}

std::string_view without_leading_zeros(std::string_view digits) {
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

std::strong_ordering compare_numbers(std::string_view a, std::string_view b) {
  a = without_leading_zeros(a);
  b = without_leading_zeros(b);
  if (a.size() != b.size()) return a.size() <=> b.size();
  return a.compare(b) <=> 0;
}

/// A file name as text, number, text, ...
struct NameParts {
  std::string folder;
  std::vector<std::string> texts;  // each stands before the digits of the same place
  std::vector<std::string> digits;
};

NameParts split(const std::string& path) {
  const std::filesystem::path whole(path);
  NameParts parts{.folder = whole.parent_path().string(), .texts = {""}, .digits = {}};
  const std::string file_name = whole.filename().string();
  for (std::string_view rest = file_name; !rest.empty();) {
    const std::string_view run = leading_run(rest);
    rest.remove_prefix(run.size());
    if (is_digit(run.front())) {
      parts.digits.emplace_back(run);
      parts.texts.emplace_back();
    } else {
      parts.texts.back() = run;
    }
  }
  return parts;
}

/// The one place where the numbers differ.
std::optional<std::size_t> varying_place(const std::vector<NameParts>& names) {
  std::optional<std::size_t> place;
  const NameParts& first = names.front();
  for (const NameParts& name : names) {
    if (name.folder != first.folder || name.texts != first.texts) return std::nullopt;
    for (std::size_t i = 0; i < first.digits.size(); ++i) {
      if (name.digits[i] == first.digits[i]) continue;
      if (place && *place != i) return std::nullopt;
      place = i;
    }
  }
  return place;
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  std::string_view rest_a = a;
  std::string_view rest_b = b;
  while (!rest_a.empty() && !rest_b.empty()) {
    const std::string_view run_a = leading_run(rest_a);
    const std::string_view run_b = leading_run(rest_b);
    const bool numbers = is_digit(run_a.front()) && is_digit(run_b.front());
    const auto order = numbers ? compare_numbers(run_a, run_b) : run_a.compare(run_b) <=> 0;
    if (order != 0) return order < 0;
    rest_a.remove_prefix(run_a.size());
    rest_b.remove_prefix(run_b.size());
  }
  if (rest_a.empty() != rest_b.empty()) return rest_a.empty();
  return a < b;  // img1 and img01: any fixed order will do
}

std::optional<std::vector<std::int64_t>> numbers_of_family(const std::vector<std::string>& paths) {
  if (paths.size() < 2) return std::nullopt;
  std::vector<NameParts> names;
  names.reserve(paths.size());
  for (const std::string& path : paths) names.push_back(split(path));
  const auto place = varying_place(names);
  if (!place) return std::nullopt;
  std::vector<std::int64_t> numbers;
  numbers.reserve(names.size());
  for (const NameParts& name : names) {
    const std::string& digits = name.digits[*place];
    constexpr std::size_t kMaxDigits = 18;  // always fits int64
    if (digits.size() > kMaxDigits) return std::nullopt;
    std::int64_t number = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), number);
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace lsv
