// SPDX-License-Identifier: BSD-3-Clause
// How the records of a chunk are stored.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "lsv/core/result.h"
#include "lsv/mcap/bytes.h"

namespace lsv::mcap {

enum class Compression { none, zstd };

/// The word that a chunk holds; empty for none.
std::string_view word(Compression compression);
std::optional<Compression> compression_from(std::string_view word);

/// Keeps its memory from chunk to chunk. One thread at a time.
class ZstdCompressor {
 public:
  ZstdCompressor();
  ZstdCompressor(ZstdCompressor&&) noexcept;
  ZstdCompressor& operator=(ZstdCompressor&&) noexcept;
  ~ZstdCompressor();

  /// Valid until the next call.
  Result<ByteView> compress(ByteView plain);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// False when `packed` says that it is something else than `plain_bytes` bytes; what does not say
/// may be any.
bool may_unpack_to(ByteView packed, std::size_t plain_bytes);

/// Fills `plain` exactly; false when `packed` is not that many bytes.
bool decompress_zstd(ByteView packed, std::span<std::byte> plain);

}  // namespace lsv::mcap
