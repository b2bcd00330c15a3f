// SPDX-License-Identifier: BSD-3-Clause
#include "tools/settings.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>

#include "calibration/text_file.h"
#include "calibration/toml.h"
#include "lsv/output/number_text.h"

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
  std::string out;
  append_shortest(out, node.as_floating_point()->get());
  return out;
}

enum Rank { kDefault, kFile, kEnvironment, kFlag };

std::string toml_number(double value) {
  std::string out;
  append_shortest(out, value);
  return out;
}
std::string toml_number(std::int64_t value) { return std::to_string(value); }
std::string toml_number(int value) { return std::to_string(value); }

Error not_a(const char* kind, const std::string& text) {
  return {ErrorCode::invalid_argument, "'" + text + "' is not " + kind};
}

/// Reads the whole text as a Number and assigns it to the target, which may be an optional.
template <typename Number, typename Target>
Settings::Parse into(Target& target, const char* type, const char* kind) {
  return {type, [&target, kind](const std::string& text) -> Result<std::string> {
            Number value{};
            const auto [end, error] =
                std::from_chars(text.data(), text.data() + text.size(), value);
            if (error != std::errc() || end != text.data() + text.size()) return not_a(kind, text);
            if constexpr (std::is_floating_point_v<Number>) {
              if (!std::isfinite(value)) return not_a(kind, text);
            }
            target = value;
            return toml_number(value);
          }};
}

Settings::Parse yes_or_no(bool& target) {
  return {"", [&target](const std::string& text) -> Result<std::string> {
            if (text != "true" && text != "false") return not_a("true or false", text);
            target = text == "true";
            return text;
          }};
}

constexpr const char* kNumber = "a finite number";
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
  entry.option = command.add_option(flag, entry.flag_text, shown)->type_name(entry.parse.type);
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

Result<void> Settings::read_toml(const std::string& text, const std::string& name,
                                 UnknownKeys unknown) {
  const toml::parse_result parsed = toml::parse(text);
  const auto at = [&](const toml::source_region& where) {
    return name + ":" + std::to_string(where.begin.line);
  };
  if (!parsed) {
    return Error{ErrorCode::bad_input, at(parsed.error().source()) + ": not valid TOML: " +
                                           std::string(parsed.error().description())};
  }
  for (const auto& [key, node] : parsed.table()) {
    Entry* const entry = find(std::string(key.str()));
    if (entry == nullptr && unknown == UnknownKeys::passed_over) continue;
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
    entry->text = *value;
    entry->source = at(node.source()) + " " + entry->key;
    entry->rank = kFile;
  }
  return {};
}

Result<void> Settings::read_environment(Variables variables) {
  constexpr std::string_view kPrefix = "LSV_";
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view assignment = *variable;
    if (!assignment.starts_with(kPrefix)) continue;
    const std::string name(assignment.substr(0, assignment.find('=')));
    const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) {
      return environment_name(e.key) == name;
    });
    if (entry == entries_.end()) {
      if (variables == Variables::some_of_other_commands) continue;
      return Error{ErrorCode::invalid_argument,
                   name + ": no setting has this name; --print-config lists them"};
    }
    entry->text = assignment.substr(std::min(name.size() + 1, assignment.size()));
    entry->source = name;
    entry->rank = kEnvironment;
  }
  return {};
}

void Settings::exclude(const std::string& key, const std::string& other_key) {
  exclusions_.emplace_back(key, other_key);
}

void Settings::resolve_exclusions() {
  for (const auto& [key, other_key] : exclusions_) {
    Entry& one = *find(key);
    Entry& other = *find(other_key);
    if (one.text.empty() || other.text.empty() || one.rank == other.rank) continue;
    (one.rank < other.rank ? one : other).text.clear();
  }
}

void Settings::use_defaults() {
  for (Entry& entry : entries_) {
    entry.text = entry.default_text;
    entry.source = "default";
    entry.rank = kDefault;
  }
}

Result<void> Settings::resolve(const std::string& config_path, Variables variables) {
  use_defaults();
  if (!config_path.empty()) {
    const Result<std::string> content = read_text_file(config_path, "configuration");
    if (!content) return content.error();
    if (Result<void> read = read_toml(content.value(), config_path, UnknownKeys::refused); !read)
      return read;
  }
  if (Result<void> read = read_environment(variables); !read) return read;
  for (Entry& entry : entries_) {
    if (entry.option->count() == 0) continue;
    if (entry.flag_text.empty())
      return Error{ErrorCode::invalid_argument, entry.flag + ": nothing was given"};
    entry.text = entry.flag_text;
    entry.source = entry.flag;
    entry.rank = kFlag;
  }
  resolve_exclusions();
  return read_values();
}

Result<void> Settings::resolve_recorded(const std::string& toml, const std::string& name) {
  use_defaults();
  if (Result<void> read = read_toml(toml, name, UnknownKeys::passed_over); !read) return read;
  return read_values();
}

Result<void> Settings::read_values() {
  for (Entry& entry : entries_) {
    if (entry.text.empty()) continue;
    Result<std::string> read = entry.parse.read(entry.text);
    if (!read) {
      const ErrorCode code =
          entry.rank == kFile ? ErrorCode::bad_input : ErrorCode::invalid_argument;
      return Error{code, entry.source + ": " + read.error().message};
    }
    entry.toml = std::move(read).value();
  }
  return {};
}

std::string Settings::to_toml() const {
  std::string out;
  for (const Entry& entry : entries_) {
    if (entry.text.empty())
      out += "# " + entry.key + " is not set\n";
    else
      out += entry.key + " = " + entry.toml + "  # " + entry.source + "\n";
  }
  return out;
}

Settings::Parse number(double& target) { return into<double>(target, "NUMBER", kNumber); }
Settings::Parse number(std::optional<double>& target) {
  return into<double>(target, "NUMBER", kNumber);
}
Settings::Parse whole(std::optional<int>& target) { return into<int>(target, "INT", kWhole); }
Settings::Parse whole(std::int64_t& target) { return into<std::int64_t>(target, "INT", kWhole); }
Settings::Parse whole(std::optional<std::int64_t>& target) {
  return into<std::int64_t>(target, "INT", kWhole);
}

Settings::Parse text(std::string& target) {
  return {"TEXT", [&target](const std::string& value) -> Result<std::string> {
            target = value;
            return toml_text(value);
          }};
}

std::string toml_text(const std::string& text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

}  // namespace lsv::cli
