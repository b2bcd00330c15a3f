// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/crc32.h"

#include <zlib.h>

namespace lsv::mcap {

std::uint32_t crc32(ByteView bytes, std::uint32_t before) {
  if (bytes.empty()) return before;  // zlib takes a null pointer for a request to start anew
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::uint32_t crc32_joined(std::uint32_t before, std::uint32_t crc, std::uint64_t size_bytes) {
  return static_cast<std::uint32_t>(::crc32_combine(before, crc, static_cast<z_off_t>(size_bytes)));
}

}  // namespace lsv::mcap
