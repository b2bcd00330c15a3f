// SPDX-License-Identifier: BSD-3-Clause
// A folder that gets its name when all files are in it; nothing that is there is overwritten.
#pragma once

#include <filesystem>
#include <string>

#include "lsv/core/result.h"

namespace lsv::cli {

class PartFolder {
 public:
  static Result<PartFolder> make(const std::string& name);
  PartFolder(PartFolder&& other) noexcept;
  PartFolder& operator=(PartFolder&&) = delete;
  /// Without commit() everything is removed.
  ~PartFolder();

  /// Path of a file in it.
  std::string file(const std::string& name) const { return (part_ / name).string(); }

  Result<void> commit();

 private:
  PartFolder() = default;
  std::filesystem::path target_;
  std::filesystem::path part_;  // empty once renamed
};

}  // namespace lsv::cli
