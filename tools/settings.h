// SPDX-License-Identifier: BSD-3-Clause
// Settings of a command with one precedence everywhere: flag > environment > configuration file >
// default, and the source of each value remembered for --print-config.
//   flag         --min-zncc 0.3
//   environment  LSV_MIN_ZNCC=0.3
//   file         min_zncc = 0.3      (TOML, flat)
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lsv/core/result.h"

namespace lsv::cli {

class Settings {
 public:
  /// How one setting is read: `read` puts a text into its target and returns it as a TOML value;
  /// its message says what is wrong with the text, without naming the setting.
  struct Parse {
    const char* type;  // for --help
    std::function<Result<std::string>(const std::string& text)> read;
  };

  /// Adds one setting to `command`. `default_text` is what --print-config and --help show when
  /// nothing else is given; empty means unset.
  void add(CLI::App& command, const std::string& key, const std::string& flag,
           const std::string& help, const std::string& default_text, Parse parse);

  /// A setting that is true or false; `flag` may hold its opposite: "--frozen,!--no-frozen".
  void add_switch(CLI::App& command, const std::string& key, const std::string& flag,
                  const std::string& help, bool& target);

  /// Says that at most one of two optional settings holds: the one from the higher source.
  void exclude(const std::string& key, const std::string& other_key);

  /// Applies all sources. `config_path` may be empty. Errors name the flag, variable or file and
  /// line. A key that no setting has is an error, and so is such an LSV_ variable unless the
  /// command has only some of the settings.
  enum class Variables { all_known, some_of_other_commands };
  Result<void> resolve(const std::string& config_path, Variables variables = Variables::all_known);

  /// Applies what to_toml() wrote, and nothing else; `name` stands for it in errors. Keys of other
  /// commands are passed over.
  Result<void> resolve_recorded(const std::string& toml, const std::string& name);

  /// The resolved settings as a TOML file that --config reads back.
  std::string to_toml() const;

 private:
  struct Entry {
    std::string key;
    std::string flag;
    std::string default_text;
    Parse parse;
    CLI::Option* option = nullptr;
    std::string flag_text;
    // In force, found by resolve() and then read into the target:
    std::string text;    // empty = unset
    std::string source;  // where it came from
    int rank = 0;        // of that source, see kDefault...
    std::string toml;
  };

  Entry& add_entry(const std::string& key, const std::string& flag, const std::string& default_text,
                   Parse parse);
  enum class UnknownKeys { refused, passed_over };
  Result<void> read_toml(const std::string& text, const std::string& name, UnknownKeys unknown);
  void use_defaults();
  Result<void> read_values();
  Result<void> read_environment(Variables variables);
  void resolve_exclusions();
  Entry* find(const std::string& key);

  std::deque<Entry> entries_;  // stable addresses: CLI11 keeps references
  std::vector<std::pair<std::string, std::string>> exclusions_;
};

/// Parsers for the usual targets, which must outlive the settings.
Settings::Parse number(double& target);
Settings::Parse number(std::optional<double>& target);
Settings::Parse whole(std::optional<int>& target);
Settings::Parse whole(std::int64_t& target);
Settings::Parse whole(std::optional<std::int64_t>& target);
Settings::Parse text(std::string& target);

/// `text` in quotes, as TOML wants it.
std::string toml_text(const std::string& text);

/// Read by a function of its own; `type` is what --help calls it.
template <typename Value>
Settings::Parse parsed_by(std::optional<Value>& target, const char* type,
                          Result<Value> (*parse)(const std::string&)) {
  return {type, [&target, parse](const std::string& text) -> Result<std::string> {
            Result<Value> value = parse(text);
            if (!value) return value.error();
            target = std::move(value).value();
            return toml_text(text);
          }};
}

}  // namespace lsv::cli
