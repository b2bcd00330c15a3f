// SPDX-License-Identifier: BSD-3-Clause
#include "tools/size_option.h"

#include <charconv>

namespace lsv::cli {

Result<void> parse_size(const std::string& text, sim::SpeckleConfig& camera) {
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, camera.width_px);
  if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
    const auto height = std::from_chars(width.ptr + 1, end, camera.height_px);
    if (height.ec == std::errc() && height.ptr == end) return {};
  }
  return Error{ErrorCode::invalid_argument,
               "--size is \"" + text + "\" but must be WIDTHxHEIGHT, such as 128x128"};
}

}  // namespace lsv::cli
