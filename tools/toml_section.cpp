// SPDX-License-Identifier: BSD-3-Clause
#include "tools/toml_section.h"

#include <algorithm>
#include <cmath>

#include "calibration/text_file.h"

namespace lsv::cli {
namespace {

std::string place(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line) + ": ";
}

}  // namespace

Result<toml::table> read_toml(const std::string& path) {
  const Result<std::string> text = read_text_file(path, "TOML");
  if (!text) return text.error();
  toml::parse_result parsed = toml::parse(text.value());
  if (!parsed) {
    return Error{ErrorCode::bad_input, place(path, parsed.error().source()) + "not valid TOML: " +
                                           std::string(parsed.error().description())};
  }
  return std::move(parsed).table();
}

const toml::node* TomlSection::find(const char* key, bool is_required) {
  asked_.emplace_back(key);
  if (error_) return nullptr;
  const toml::node* const node = table_ == nullptr ? nullptr : table_->get(key);
  if (node == nullptr && is_required) {
    error_ =
        Error{ErrorCode::bad_input, file_ + ": the key " + section_ + "." + key + " is missing"};
  }
  return node;
}

void TomlSection::fail(const char* key, const std::string& sentence) {
  if (error_) return;
  const toml::node* const node = table_ == nullptr ? nullptr : table_->get(key);
  error_ =
      Error{ErrorCode::bad_input, (node == nullptr ? file_ + ": " : place(file_, node->source())) +
                                      section_ + "." + key + " " + sentence};
}

void TomlSection::number(const char* key, double& out, bool is_required) {
  const toml::node* const node = find(key, is_required);
  if (node == nullptr) return;
  const std::optional<double> value =
      node->is_number() ? node->value<double>() : std::optional<double>();
  if (!value || !std::isfinite(*value)) return fail(key, "must be a finite number");
  out = *value;
}

void TomlSection::optional(const char* key, std::string& out) {
  const toml::node* const node = find(key, false);
  if (node == nullptr) return;
  if (!node->is_string()) return fail(key, "must be a text in quotes");
  out = node->as_string()->get();
}

void TomlSection::optional_whole(const char* key, int& out) {
  double value = out;
  number(key, value, false);
  if (error_) return;
  if (value != std::floor(value) || std::abs(value) > 1e9)
    return fail(key, "must be a whole number");
  out = static_cast<int>(value);
}

std::optional<Error> TomlSection::finish() {
  if (table_ == nullptr) return error_;
  for (const auto& [key, node] : *table_) {
    if (std::ranges::find(asked_, key.str()) != asked_.end()) continue;
    return Error{ErrorCode::bad_input, place(file_, key.source()) + "unknown key " +
                                           (section_.empty() ? "" : section_ + ".") +
                                           std::string(key.str())};
  }
  return error_;
}

}  // namespace lsv::cli
