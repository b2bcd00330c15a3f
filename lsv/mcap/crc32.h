// SPDX-License-Identifier: BSD-3-Clause
// CRC-32 as in zlib, of bytes that come piece by piece.
#pragma once

#include <cstdint>

#include "lsv/mcap/bytes.h"

namespace lsv::mcap {

/// Of what `before` is the CRC of, followed by `bytes`.
std::uint32_t crc32(ByteView bytes, std::uint32_t before = 0);

/// The same from the CRC of the second part alone, without reading it again.
std::uint32_t crc32_joined(std::uint32_t before, std::uint32_t crc, std::uint64_t size_bytes);

}  // namespace lsv::mcap
