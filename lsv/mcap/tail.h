// SPDX-License-Identifier: BSD-3-Clause
// The open chunk as a file beside the recording, FILE.tail, so that it outlives the process: memory
// shared with the file takes each message at once, without a system call. All of its space is taken
// from the disk at the start, so a full disk does not stop it.
//
// Layout: magic and size in the first page, with two slots that say what is committed; then the
// records. A commit writes the slot that the one before did not, so a process killed in the middle
// of it leaves that one. The tail belongs to the recording while its chunk is not in there.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "lsv/core/result.h"
#include "lsv/mcap/byte_source.h"
#include "lsv/mcap/chunk_memory.h"

namespace lsv::mcap {

std::string tail_path(const std::string& recording_path);

class TailFile : public ChunkMemory {
 public:
  /// For chunks of up to `chunk_bytes`. output_failed when the file exists: then a recording of
  /// that name was cut short, and the file holds its end.
  static Result<std::unique_ptr<TailFile>> create(const std::string& path, std::size_t chunk_bytes);

  TailFile(const TailFile&) = delete;
  TailFile& operator=(const TailFile&) = delete;
  /// Leaves the file where it is.
  ~TailFile() override;

  std::span<std::byte> bytes() override;
  bool grow(std::size_t size_bytes) override { return size_bytes <= bytes().size(); }
  void commit(std::uint64_t number, std::size_t length_bytes, std::uint32_t crc) override;

  /// The recording has everything.
  void remove();

 private:
  TailFile(std::string path, std::byte* map, std::size_t map_bytes);

  std::string path_;
  std::byte* map_;
  std::size_t map_bytes_;
  unsigned next_slot_ = 0;
};

struct TailContent {
  std::uint64_t chunk = 0;  // its number in the recording, from 0
  Bytes records;
};

/// What was committed last. Empty when nothing was, or when it is damaged.
Result<std::optional<TailContent>> read_tail(ByteSource& source);

}  // namespace lsv::mcap
