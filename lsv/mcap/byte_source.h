// SPDX-License-Identifier: BSD-3-Clause
// Where the bytes of a recording come from: a file of known size, read at any place.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "lsv/core/result.h"
#include "lsv/mcap/bytes.h"

namespace lsv::mcap {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// For error messages.
  virtual const std::string& name() const = 0;
  virtual std::uint64_t size_bytes() const = 0;
  /// Fills `into` from `offset` on; both lie inside the size.
  virtual Result<void> read(std::uint64_t offset, std::span<std::byte> into) = 0;
};

/// A regular file. Of one that still grows, what was there at opening.
Result<std::unique_ptr<ByteSource>> open_file(const std::string& path);

std::unique_ptr<ByteSource> memory_source(std::string name, Bytes bytes);

}  // namespace lsv::mcap
