// SPDX-License-Identifier: BSD-3-Clause
// The pixel formats of GenICam (PFNC) that lsv reads: unpacked grey values, little-endian on the
// wire. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "lsv/core/frame.h"

namespace lsv {

struct MonoFormat {
  std::string_view name;    // "Mono12"
  std::uint32_t pfnc_code;  // of every frame on the wire
  PixelType type;
  int bit_depth;
};

std::optional<MonoFormat> mono_format(std::string_view name);
std::optional<MonoFormat> mono_format(std::uint32_t pfnc_code);

/// "Mono8, Mono10, ... and Mono16", for messages.
std::string mono_format_names();

}  // namespace lsv
