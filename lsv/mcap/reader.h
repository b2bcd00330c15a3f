// SPDX-License-Identifier: BSD-3-Clause
// Reads an MCAP file from front to back: messages, metadata and attachments in the order in which
// they lie there. Checks every CRC that the file has; sizes are held against the file and against
// kMaxRecord_bytes before memory is taken. Chunks may be plain or zstd.
// One thread at a time.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lsv/core/result.h"
#include "lsv/mcap/byte_source.h"
#include "lsv/mcap/records.h"

namespace lsv::mcap {

inline constexpr std::uint64_t kMaxRecord_bytes = std::uint64_t{128} << 20;

/// What to do about what cannot be right.
enum class Damage {
  refuse,  // end with an error; a file that was never finished is refused at opening
  skip,    // note it and go on at the next chunk whose CRC is right
};

struct Message {
  const Channel* channel = nullptr;  // lives as long as the reader
  std::uint16_t channel_id = 0;      // in this file
  std::uint32_t sequence = 0;
  std::int64_t log_time_ns = 0;
  std::int64_t publish_time_ns = 0;
  ByteView payload;  // until the next call
};

/// How the file was found, complete once the end was reached.
struct FileCondition {
  bool finished = false;             // ends with a sound summary and footer
  std::uint64_t chunks = 0;          // that are sound
  std::uint32_t last_chunk_crc = 0;  // of the records of the last of these
  std::uint64_t damages = 0;         // places that were skipped
  std::string first_damage{};        // a sentence; empty without one
  bool torn_end = false;             // nothing sound follows the last of them
  /// Where the last sound chunk, and what belongs to it, ends.
  std::uint64_t sound_bytes = 0;
};

enum class Item { message, metadata, attachment, end };

class Reader {
 public:
  /// bad_input when it is no MCAP file, or is damaged and Damage::refuse.
  static Result<Reader> open(std::unique_ptr<ByteSource> source, Damage damage);

  /// Moves to the next item. After an error the reader is finished.
  Result<Item> next();

  /// Records that follow the end of the file, as next() then hands them out; bad_input, and nothing
  /// changed, when they do not belong to it.
  Result<void> add_chunk(Bytes records);

  const Message& message() const { return message_; }
  const Metadata& metadata() const { return metadata_; }
  const Attachment& attachment() const { return attachment_; }
  const FileCondition& condition() const { return condition_; }

 private:
  struct Record {
    Opcode opcode{};
    std::uint64_t size_bytes = 0;  // with its head
    ByteView content;
  };
  struct ChunkHead {
    std::uint64_t plain_bytes = 0;
    std::uint32_t plain_crc = 0;
    std::string_view compression;
    ByteView stored;
  };

  Reader(std::unique_ptr<ByteSource> source, Damage damage);
  Result<void> check_magic();
  Result<bool> next_in_file(Item& item);
  bool next_in_chunk();
  Result<Record> read_record(std::uint64_t offset_bytes);
  Result<bool> take(const Record& record, Item& item);
  bool read_whole(const ByteReader& in) const;
  Result<void> take_definition(Opcode opcode, ByteView content);
  Result<void> take_schema(ByteView content);
  Result<void> take_channel(ByteView content);
  Result<void> take_message(ByteView content);
  Result<void> take_metadata(ByteView content);
  Result<void> take_attachment(ByteView content);
  Result<void> take_chunk(ByteView content);
  Result<ByteView> plain_records(const ChunkHead& head);
  Result<void> check_records(ByteView records);
  Result<void> check_end(ByteView data_end, std::uint64_t end_bytes);
  Result<std::uint32_t> crc_of_file(std::uint64_t from_bytes, std::uint64_t to_bytes);
  Result<bool> skip_damage(const Error& error);
  Result<bool> find_chunk(std::uint64_t from_bytes);
  bool is_sound_chunk(std::uint64_t offset_bytes, ByteView start);
  Error wrong(const std::string& what) const;

  std::unique_ptr<ByteSource> source_;
  Damage damage_;
  std::uint64_t offset_bytes_ = 0;  // of the record that is looked at
  std::uint32_t file_crc_ = 0;      // of everything before it
  bool file_crc_known_ = true;      // nothing was skipped
  bool at_end_ = false;
  std::uint64_t search_budget_bytes_;  // left to read while looking for sound chunks

  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::unique_ptr<Channel>> channels_;

  Bytes record_;  // read last
  Bytes decompressed_;
  ByteView chunk_;  // records still to be handed out

  Message message_;
  Metadata metadata_;
  Attachment attachment_;
  FileCondition condition_;
};

}  // namespace lsv::mcap
