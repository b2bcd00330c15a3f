// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/base64.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace lsv {

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(bytes.size() - i, 3);
    std::uint32_t triple = 0;
    for (std::size_t k = 0; k < 3; ++k)
      triple = triple << 8 | (k < count ? bytes[i + k] : std::uint8_t{0});
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= count ? kDigits[triple >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

}  // namespace lsv
