// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/sealed.h"

#include <string>

#include "lsv/mcap/crc32.h"

namespace lsv::mcap {
namespace {

constexpr const char* kSeal = "crc32";

std::string seal_of(const Metadata& metadata) {
  Bytes bytes;
  ByteWriter out(bytes);
  out.text(metadata.name);
  for (const auto& [key, value] : metadata.entries) {
    if (key == kSeal) continue;
    out.text(key);
    out.text(value);
  }
  return std::to_string(crc32(bytes));
}

}  // namespace

Metadata sealed(Metadata metadata) {
  metadata.entries[kSeal] = seal_of(metadata);
  return metadata;
}

bool is_sealed(const Metadata& metadata) {
  const auto seal = metadata.entries.find(kSeal);
  return seal != metadata.entries.end() && seal->second == seal_of(metadata);
}

}  // namespace lsv::mcap
