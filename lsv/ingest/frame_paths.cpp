// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/frame_paths.h"

#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "lsv/ingest/raw_source.h"

namespace lsv {
namespace {

namespace fs = std::filesystem;

Result<FramePaths> files_in(const std::string& folder, bool raw) {
  FramePaths out{.files = {}, .order = ListOrder::natural};
  std::error_code failure;
  for (fs::directory_iterator it(folder, failure), end; !failure && it != end;
       it.increment(failure)) {
    std::error_code ignored;
    const std::string path = it->path().string();
    const bool wanted = raw ? is_raw_path(path) : image_kind_of(path).has_value();
    if (wanted && !it->is_directory(ignored)) out.files.push_back(path);
  }
  if (failure) {
    return Error{ErrorCode::bad_input,
                 folder + ": the folder cannot be read: " + failure.message()};
  }
  if (out.files.empty()) {
    return Error{ErrorCode::bad_input,
                 folder + ": the folder holds no " +
                     (raw ? "raw file (.raw .bin .y8 .y16)"
                          : "image file (.png .tif .tiff .pgm .bmp .jpg .jpeg)") +
                     "; for other names give a pattern such as '" + folder + "/*.dat'"};
  }
  std::sort(out.files.begin(), out.files.end());
  return out;
}

Result<FramePaths> matches_of(const std::string& pattern) {
  glob_t found{};
  const int status = ::glob(pattern.c_str(), 0, nullptr, &found);
  FramePaths out{.files = {}, .order = ListOrder::natural};
  for (std::size_t i = 0; i < found.gl_pathc; ++i) out.files.emplace_back(found.gl_pathv[i]);
  ::globfree(&found);
  if (status != 0 || out.files.empty())
    return Error{ErrorCode::bad_input, pattern + ": no file matches this pattern"};
  return out;
}

}  // namespace

Result<FramePaths> expand_frame_paths(const std::vector<std::string>& paths, bool raw) {
  if (paths.empty() || std::count(paths.begin(), paths.end(), std::string()) > 0) {
    return Error{ErrorCode::invalid_argument,
                 "no frames are named; give a folder, files, a pattern, or - for standard input"};
  }
  if (paths.size() > 1 || paths.front() == "-") return FramePaths{.files = paths};
  const std::string& path = paths.front();
  std::error_code failure;
  const fs::file_status status = fs::status(path, failure);
  if (fs::is_directory(status)) return files_in(path, raw);
  if (!fs::exists(status) && path.find_first_of("*?[") != std::string::npos)
    return matches_of(path);
  return FramePaths{.files = paths};
}

Result<void> check_image_list(const std::vector<std::string>& files) {
  const std::string& first = files.front();
  for (const std::string& file : files) {
    const auto kind = image_kind_of(file);
    if (!kind && files.size() == 1) {
      return Error{ErrorCode::unsupported,
                   file +
                       ": the extension is not one that lsv reads; raw frames need --raw, for "
                       "example --raw 640x480:mono8"};
    }
    if (!kind) {
      return Error{ErrorCode::invalid_argument,
                   file +
                       ": only image files (.png .tif .tiff .pgm .bmp .jpg .jpeg) can be given "
                       "together; give a folder, a raw file, a video or - alone"};
    }
    if (kind != image_kind_of(first)) {
      return Error{ErrorCode::invalid_argument,
                   file + ": is a " + std::string(word(*kind)) + " among " +
                       std::string(word(*image_kind_of(first))) +
                       " files; choose one format with a pattern such as '" +
                       (fs::path(first).parent_path() / "*").string() +
                       fs::path(first).extension().string() + "'"};
    }
  }
  return {};
}

}  // namespace lsv
