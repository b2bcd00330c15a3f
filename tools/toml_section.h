// SPDX-License-Identifier: BSD-3-Clause
// One table of a TOML file, key by key. The first thing that is wrong is kept and what follows is
// skipped; a key that nobody asked for is told first: it is that key misspelt.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/toml.h"
#include "lsv/core/result.h"

namespace lsv::cli {

class TomlSection {
 public:
  /// `file` and `section` stand in messages; `table` may be null: then every optional key keeps its
  /// value. All must outlive the reader.
  TomlSection(const std::string& file, const toml::table* table, std::string section)
      : file_(file), table_(table), section_(std::move(section)) {}

  /// The value of a key that must be there.
  void required(const char* key, double& out) { number(key, out, true); }
  /// Leaves `out` as it is when there is no such key.
  void optional(const char* key, double& out) { number(key, out, false); }
  void optional(const char* key, std::string& out);
  void optional_whole(const char* key, int& out);

  void fail(const char* key, const std::string& sentence);
  std::optional<Error> finish();

 private:
  const toml::node* find(const char* key, bool is_required);
  void number(const char* key, double& out, bool is_required);

  const std::string& file_;
  const toml::table* table_;
  std::string section_;
  std::vector<std::string_view> asked_;
  std::optional<Error> error_;
};

/// The whole of a file; errors name file and line.
Result<toml::table> read_toml(const std::string& path);

}  // namespace lsv::cli
