// SPDX-License-Identifier: BSD-3-Clause
// Bytes as text that may stand in a page (RFC 4648, with padding).
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lsv {

std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace lsv
