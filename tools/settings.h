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

#include "lsv/core/result.h"

namespace lsv::cli {

class Settings {
 public:
  /// Reads `text` into its target; the message says what is wrong with it, without its name.
  using Parse = std::function<Result<void>(const std::string& text)>;

  /// Adds one setting to `command`. `default_text` is what --print-config and --help show when
  /// nothing else is given; empty means unset.
  void add(CLI::App& command, const std::string& key, const std::string& flag,
           const std::string& help, const std::string& default_text, Parse parse);

  /// A setting that is true or false; `flag` may hold its opposite: "--frozen,!--no-frozen".
  void add_switch(CLI::App& command, const std::string& key, const std::string& flag,
                  const std::string& help, bool& target);

  /// Applies all sources. `config_path` may be empty. Errors name the flag, variable or file and
  /// line.
  Result<void> resolve(const std::string& config_path);

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
    std::string text;    // in force; empty = unset
    std::string source;  // where it came from
  };

  Entry& add_entry(const std::string& key, const std::string& flag, const std::string& default_text,
                   Parse parse);
  Result<void> read_file(const std::string& path);
  Result<void> apply(Entry& entry, const std::string& text, const std::string& source);
  Entry* find(const std::string& key);

  std::deque<Entry> entries_;  // stable addresses: CLI11 keeps references
};

/// Parsers for the usual targets, which must outlive the settings.
Settings::Parse number(double& target);
Settings::Parse number(std::optional<double>& target);
Settings::Parse whole(std::optional<int>& target);
Settings::Parse whole(std::int64_t& target);
Settings::Parse whole(std::optional<std::int64_t>& target);
Settings::Parse text(std::string& target);

}  // namespace lsv::cli
