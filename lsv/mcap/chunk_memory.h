// SPDX-License-Identifier: BSD-3-Clause
// Where the records of the open chunk lie until the chunk is written to the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

#include "lsv/mcap/bytes.h"

namespace lsv::mcap {

class ChunkMemory {
 public:
  virtual ~ChunkMemory() = default;
  /// Stays at its place unless grow() is called.
  virtual std::span<std::byte> bytes() = 0;
  /// Room for at least `size_bytes`, with the content kept; false where that cannot be.
  virtual bool grow(std::size_t size_bytes) = 0;
  /// The first `length_bytes`, whose CRC-32 is `crc`, are complete records of chunk `number`; they
  /// are not written to until a commit with another number.
  virtual void commit(std::uint64_t number, std::size_t length_bytes, std::uint32_t crc) = 0;
};

/// Lost with the process.
class HeapChunk : public ChunkMemory {
 public:
  explicit HeapChunk(std::size_t size_bytes)
      : bytes_(std::make_unique_for_overwrite<std::byte[]>(size_bytes)), size_bytes_(size_bytes) {}

  std::span<std::byte> bytes() override { return {bytes_.get(), size_bytes_}; }
  bool grow(std::size_t size_bytes) override {
    if (size_bytes <= size_bytes_) return true;
    auto larger = std::make_unique_for_overwrite<std::byte[]>(size_bytes);
    std::memcpy(larger.get(), bytes_.get(), size_bytes_);
    bytes_ = std::move(larger);
    size_bytes_ = size_bytes;
    return true;
  }
  void commit(std::uint64_t, std::size_t, std::uint32_t) override {}

 private:
  std::unique_ptr<std::byte[]> bytes_;  // only what is used is ever touched
  std::size_t size_bytes_;
};

}  // namespace lsv::mcap
