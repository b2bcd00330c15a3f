// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/text_file.h"

#include <filesystem>
#include <fstream>

namespace lsv {
namespace {

constexpr std::uintmax_t kMiB = std::uintmax_t{1} << 20;

}  // namespace

Result<std::string> read_text_file(const std::string& path, const std::string& kind) {
  return read_whole_file(path, kind, kMiB);
}

Result<std::string> read_whole_file(const std::string& path, const std::string& kind,
                                    std::uintmax_t max_bytes) {
  const auto refuse = [&](const std::string& why) {
    return Error{ErrorCode::bad_input, path + ": " + why};
  };
  std::error_code status;
  if (std::filesystem::is_directory(path, status))
    return refuse("is a folder, not a " + kind + " file");
  if (!std::filesystem::is_regular_file(path, status))
    return refuse("there is no such " + kind + " file");
  const std::uintmax_t size_bytes = std::filesystem::file_size(path, status);
  if (status || size_bytes > max_bytes) {
    return refuse("larger than " + std::to_string((max_bytes + kMiB - 1) / kMiB) +
                  " MiB, so not a " + kind + " file");
  }
  std::ifstream file(path, std::ios::binary);
  std::string bytes(size_bytes, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(size_bytes));
  if (!file) return refuse("cannot be read");
  return bytes;
}

}  // namespace lsv
