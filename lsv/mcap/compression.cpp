// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/compression.h"

#include <zstd.h>

#include <string>

namespace lsv::mcap {

namespace {

// The fastest of the regular levels: camera noise hardly compresses at any.
constexpr int kLevel = 1;

}  // namespace

std::string_view word(Compression compression) {
  return compression == Compression::zstd ? "zstd" : "";
}

std::optional<Compression> compression_from(std::string_view word) {
  if (word.empty()) return Compression::none;
  if (word == "zstd") return Compression::zstd;
  return std::nullopt;
}

struct ZstdCompressor::Context {
  struct Free {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };
  std::unique_ptr<ZSTD_CCtx, Free> zstd{ZSTD_createCCtx()};
  Bytes packed;
};

ZstdCompressor::ZstdCompressor() : context_(std::make_unique<Context>()) {}
ZstdCompressor::ZstdCompressor(ZstdCompressor&&) noexcept = default;
ZstdCompressor& ZstdCompressor::operator=(ZstdCompressor&&) noexcept = default;
ZstdCompressor::~ZstdCompressor() = default;

Result<ByteView> ZstdCompressor::compress(ByteView plain) {
  Bytes& packed = context_->packed;
  if (const std::size_t bound = ZSTD_compressBound(plain.size()); packed.size() < bound)
    packed.resize(bound);
  const std::size_t size = ZSTD_compressCCtx(context_->zstd.get(), packed.data(), packed.size(),
                                             plain.data(), plain.size(), kLevel);
  if (ZSTD_isError(size) != 0) {
    return Error{ErrorCode::output_failed,
                 std::string("a chunk cannot be compressed: ") + ZSTD_getErrorName(size)};
  }
  return ByteView(packed.data(), size);
}

bool may_unpack_to(ByteView packed, std::size_t plain_bytes) {
  const unsigned long long told = ZSTD_getFrameContentSize(packed.data(), packed.size());
  // Several frames may follow each other, and then the first tells a part.
  return told == ZSTD_CONTENTSIZE_UNKNOWN ||
         (told != ZSTD_CONTENTSIZE_ERROR && told <= plain_bytes);
}

bool decompress_zstd(ByteView packed, std::span<std::byte> plain) {
  return ZSTD_decompress(plain.data(), plain.size(), packed.data(), packed.size()) == plain.size();
}

}  // namespace lsv::mcap
