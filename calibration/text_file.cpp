// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/text_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

namespace lsv {

Result<std::string> read_text_file(const std::string& path, const std::string& kind) {
  constexpr std::uintmax_t kMaxFile_bytes = 1 << 20;
  const auto refuse = [&](const std::string& why) {
    return Error{ErrorCode::bad_input, path + ": " + why};
  };
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status))
    return refuse("there is no such " + kind + " file");
  const std::uintmax_t size_bytes = std::filesystem::file_size(path, status);
  if (status || size_bytes > kMaxFile_bytes)
    return refuse("larger than 1 MiB, so not a " + kind + " file");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (size_bytes > 0) text << file.rdbuf();
  if (!file || !text) return refuse("cannot be read");
  return text.str();
}

}  // namespace lsv
