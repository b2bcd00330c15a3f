// SPDX-License-Identifier: BSD-3-Clause
#include "tools/settings.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "calibration/text_file.h"
#include "calibration/toml.h"

namespace lsv::cli {
namespace {

std::string environment_name(const std::string& key) {
  std::string out = "LSV_";
  for (const char c : key) out += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

/// The text of a TOML value as a flag would give it; empty for tables, arrays and dates.
std::optional<std::string> as_text(const toml::node& node) {
  if (node.is_string()) return node.as_string()->get();
  if (node.is_boolean()) return node.as_boolean()->get() ? "true" : "false";
  if (node.is_integer()) return std::to_string(node.as_integer()->get());
  if (!node.is_floating_point()) return std::nullopt;
  std::ostringstream out;
  out.precision(17);
  out << node.as_floating_point()->get();
  return out.str();
}

bool reads_as_toml_number_or_bool(const std::string& text) {
  if (text == "true" || text == "false") return true;
  double ignored = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ignored);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(ignored);
}

std::string toml_value(const std::string& text) {
  if (reads_as_toml_number_or_bool(text)) return text;
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

Error not_a(const char* kind, const std::string& text) {
  return {ErrorCode::invalid_argument, "'" + text + "' is not " + kind};
}

/// Reads the whole text as a Number and assigns it to the target, which may be an optional.
template <typename Number, typename Target>
Settings::Parse into(Target& target, const char* kind) {
  return [&target, kind](const std::string& text) -> Result<void> {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return not_a(kind, text);
    target = value;
    return {};
  };
}

Settings::Parse yes_or_no(bool& target) {
  return [&target](const std::string& text) -> Result<void> {
    if (text != "true" && text != "false") return not_a("true or false", text);
    target = text == "true";
    return {};
  };
}

constexpr const char* kNumber = "a number";
constexpr const char* kWhole = "a whole number";

}  // namespace

Settings::Entry& Settings::add_entry(const std::string& key, const std::string& flag,
                                     const std::string& default_text, Parse parse) {
  Entry& entry = entries_.emplace_back();
  entry.key = key;
  entry.flag = flag;
  entry.default_text = default_text;
  entry.parse = std::move(parse);
  return entry;
}

void Settings::add(CLI::App& command, const std::string& key, const std::string& flag,
                   const std::string& help, const std::string& default_text, Parse parse) {
  Entry& entry = add_entry(key, flag, default_text, std::move(parse));
  const std::string shown = default_text.empty() ? help : help + " [" + default_text + "]";
  entry.option = command.add_option(flag, entry.flag_text, shown);
}

void Settings::add_switch(CLI::App& command, const std::string& key, const std::string& flag,
                          const std::string& help, bool& target) {
  Entry& entry = add_entry(key, flag, target ? "true" : "false", yes_or_no(target));
  entry.option = command.add_flag(flag, entry.flag_text, help);
}

Settings::Entry* Settings::find(const std::string& key) {
  for (Entry& entry : entries_) {
    if (entry.key == key) return &entry;
  }
  return nullptr;
}

Result<void> Settings::apply(Entry& entry, const std::string& text, const std::string& source) {
  if (const Result<void> parsed = entry.parse(text); !parsed)
    return Error{ErrorCode::invalid_argument, source + ": " + parsed.error().message};
  entry.text = text;
  entry.source = source;
  return {};
}

Result<void> Settings::read_file(const std::string& path) {
  const Result<std::string> content = read_text_file(path, "configuration");
  if (!content) return content.error();
  const toml::parse_result parsed = toml::parse(content.value());
  const auto at = [&](const toml::source_region& where) {
    return path + ":" + std::to_string(where.begin.line);
  };
  if (!parsed) {
    return Error{ErrorCode::bad_input, at(parsed.error().source()) + ": not valid TOML: " +
                                           std::string(parsed.error().description())};
  }
  for (const auto& [key, node] : parsed.table()) {
    Entry* const entry = find(std::string(key.str()));
    if (entry == nullptr) {
      return Error{ErrorCode::bad_input, at(key.source()) + ": unknown key " +
                                             std::string(key.str()) +
                                             "; --print-config lists the known ones"};
    }
    const std::optional<std::string> value = as_text(node);
    if (!value) {
      return Error{ErrorCode::bad_input,
                   at(node.source()) + ": " + entry->key + " must be a number, word or text"};
    }
    if (Result<void> applied = apply(*entry, *value, at(node.source()) + " " + entry->key);
        !applied)
      return Error{ErrorCode::bad_input, applied.error().message};
  }
  return {};
}

Result<void> Settings::resolve(const std::string& config_path) {
  for (Entry& entry : entries_) {
    entry.text = entry.default_text;
    entry.source = "default";
  }
  if (!config_path.empty()) {
    if (Result<void> read = read_file(config_path); !read) return read;
  }
  for (Entry& entry : entries_) {
    const std::string variable = environment_name(entry.key);
    if (const char* const value = std::getenv(variable.c_str()); value != nullptr) {
      if (Result<void> applied = apply(entry, value, variable); !applied) return applied;
    }
    if (entry.option->count() > 0) {
      if (Result<void> applied = apply(entry, entry.flag_text, entry.flag); !applied)
        return applied;
    }
  }
  return {};
}

std::string Settings::to_toml() const {
  std::ostringstream out;
  for (const Entry& entry : entries_) {
    if (entry.text.empty())
      out << "# " << entry.key << " is not set\n";
    else
      out << entry.key << " = " << toml_value(entry.text) << "  # " << entry.source << "\n";
  }
  return out.str();
}

Settings::Parse number(double& target) { return into<double>(target, kNumber); }
Settings::Parse number(std::optional<double>& target) { return into<double>(target, kNumber); }
Settings::Parse whole(std::optional<int>& target) { return into<int>(target, kWhole); }
Settings::Parse whole(std::int64_t& target) { return into<std::int64_t>(target, kWhole); }
Settings::Parse whole(std::optional<std::int64_t>& target) {
  return into<std::int64_t>(target, kWhole);
}

Settings::Parse text(std::string& target) {
  return [&target](const std::string& value) -> Result<void> {
    target = value;
    return {};
  };
}

}  // namespace lsv::cli
