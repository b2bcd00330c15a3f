// SPDX-License-Identifier: BSD-3-Clause
#include "tools/part_folder.h"

#include <system_error>
#include <utility>

namespace lsv::cli {

namespace fs = std::filesystem;

namespace {

Error usage(std::string message) { return {ErrorCode::invalid_argument, std::move(message)}; }

Error not_written(const fs::path& path, const std::error_code& status) {
  return {ErrorCode::output_failed, "cannot write " + path.string() + ": " + status.message()};
}

}  // namespace

Result<PartFolder> PartFolder::make(const std::string& name) {
  PartFolder out;
  out.target_ = name;
  if (!out.target_.has_filename()) out.target_ = out.target_.parent_path();
  std::error_code status;
  if (out.target_.empty() ||
      (fs::exists(out.target_, status) &&
       !(fs::is_directory(out.target_, status) && fs::is_empty(out.target_, status))))
    return usage(name + " exists already: remove it or choose another name");
  const fs::path part = out.target_.string() + ".part";
  if (!fs::create_directories(part, status)) {
    if (status) return not_written(part, status);
    return usage(part.string() + " is left from a run that was cut short: remove it first");
  }
  out.part_ = part;
  return out;
}

PartFolder::PartFolder(PartFolder&& other) noexcept
    : target_(std::move(other.target_)), part_(std::exchange(other.part_, {})) {}

PartFolder::~PartFolder() {
  std::error_code ignored;
  if (!part_.empty()) fs::remove_all(part_, ignored);
}

Result<void> PartFolder::commit() {
  std::error_code status;
  fs::rename(part_, target_, status);
  if (status) return not_written(target_, status);
  part_.clear();
  return {};
}

}  // namespace lsv::cli
