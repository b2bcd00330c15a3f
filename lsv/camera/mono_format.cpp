// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/camera/mono_format.h"

#include <algorithm>
#include <array>

namespace lsv {
namespace {

// Codes: EMVA, Pixel Format Naming Convention 2.4, 32-bit values.
constexpr std::array<MonoFormat, 5> kFormats = {{{"Mono8", 0x01080001, PixelType::mono8, 8},
                                                 {"Mono10", 0x01100003, PixelType::mono16, 10},
                                                 {"Mono12", 0x01100005, PixelType::mono16, 12},
                                                 {"Mono14", 0x01100025, PixelType::mono16, 14},
                                                 {"Mono16", 0x01100007, PixelType::mono16, 16}}};

template <typename Matches>
std::optional<MonoFormat> find(Matches matches) {
  const auto* const found = std::find_if(kFormats.begin(), kFormats.end(), matches);
  if (found == kFormats.end()) return std::nullopt;
  return *found;
}

}  // namespace

std::optional<MonoFormat> mono_format(std::string_view name) {
  return find([name](const MonoFormat& format) { return format.name == name; });
}

std::optional<MonoFormat> mono_format(std::uint32_t pfnc_code) {
  return find([pfnc_code](const MonoFormat& format) { return format.pfnc_code == pfnc_code; });
}

std::string mono_format_names() {
  std::string text;
  for (const MonoFormat& format : kFormats) {
    if (!text.empty()) text += &format == &kFormats.back() ? " and " : ", ";
    text += format.name;
  }
  return text;
}

}  // namespace lsv
