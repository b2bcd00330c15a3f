// SPDX-License-Identifier: BSD-3-Clause
// Writes an MCAP file chunk by chunk. Each chunk holds the definitions of all channels, so that it
// can be read when everything before it is lost; a recording that is never finished consists of
// whole chunks.
//
// A call that fails leaves the file cut back to the last whole record and the open chunk as it was:
// the call may be repeated, for example when the disk has space again. One thread at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lsv/core/result.h"
#include "lsv/mcap/byte_sink.h"
#include "lsv/mcap/chunk_memory.h"
#include "lsv/mcap/compression.h"
#include "lsv/mcap/records.h"

namespace lsv::mcap {

using ChannelId = std::uint16_t;

struct WriterOptions {
  std::string profile = "ros2";
  std::string library = "lsv";
  Compression compression = Compression::none;
};

struct MessageHead {
  ChannelId channel = 0;
  std::uint32_t sequence = 0;
  std::int64_t log_time_ns = 0;      // >= 0
  std::int64_t publish_time_ns = 0;  // >= 0
};

class Writer {
 public:
  /// Writes the header. A chunk is as large as `chunk` is.
  static Result<Writer> create(std::unique_ptr<ByteSink> sink, std::unique_ptr<ChunkMemory> chunk,
                               const WriterOptions& options);

  Result<ChannelId> add_channel(const Channel& channel);
  Result<void> add_metadata(const Metadata& metadata);
  Result<void> add_attachment(const Attachment& attachment);

  /// Makes sure that `messages` messages of together `payload_bytes` fit into the open chunk, which
  /// is flushed if need be; write() cannot fail for these. invalid_argument when no chunk is large
  /// enough.
  Result<void> make_room(std::size_t messages, std::size_t payload_bytes);
  /// Whether that is so already, without a flush.
  bool has_room(std::size_t messages, std::size_t payload_bytes) const;
  Result<void> write(const MessageHead& head, ByteView payload);
  /// What was written so far outlives the process, where the memory of the chunk does.
  void commit();
  /// Writes the open chunk to the file.
  Result<void> flush();
  /// What was flushed outlives a power cut.
  Result<void> sync() { return sink_->sync(); }
  /// Flushes, adds summary and footer, syncs. Nothing may be written afterwards.
  Result<void> finish();

  std::uint64_t chunks() const { return chunk_count_; }
  bool has_open_messages() const { return !open_index_.empty(); }

 private:
  struct ChunkEntry {
    std::uint64_t offset_bytes = 0;
    std::uint64_t index_bytes = 0;  // of the message indexes after it
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    std::uint32_t length_bytes = 0;
    std::uint32_t stored_bytes = 0;  // of its records
    std::uint32_t plain_bytes = 0;
    std::uint32_t channel_count = 0;  // entries of channel_offsets_
  };
  struct ChannelOffset {
    ChannelId channel = 0;
    std::uint32_t after_chunk_bytes = 0;
  };
  struct IndexEntry {
    ChannelId channel = 0;
    std::uint64_t log_time_ns = 0;
    std::uint64_t offset_bytes = 0;
  };

  Writer(std::unique_ptr<ByteSink> sink, std::unique_ptr<ChunkMemory> chunk,
         const WriterOptions& options);
  Result<void> append(ByteView bytes) { return append(bytes, {}, 0, {}); }
  Result<void> append(ByteView head, ByteView body, std::uint32_t body_crc, ByteView tail);
  Result<std::uint64_t> append_record(Opcode opcode, ByteView content);
  bool may_hold(std::size_t size_bytes);
  void start_chunk();
  void put_message_indexes(ChunkEntry& entry, std::vector<ChannelOffset>& offsets, Bytes& out);
  Bytes statistics() const;
  Bytes chunk_index(const ChunkEntry& entry, std::size_t& next_offset) const;
  Bytes end_of_file();

  std::unique_ptr<ByteSink> sink_;
  std::unique_ptr<ChunkMemory> chunk_;
  Compression compression_;
  ZstdCompressor compressor_;

  std::uint64_t good_bytes_ = 0;  // of the file: whole records only
  std::uint32_t file_crc_ = 0;    // of these
  bool torn_ = false;             // something follows them that could not be cut off

  std::vector<Schema> schemas_;
  std::vector<std::uint64_t> message_counts_;  // by channel, of the file
  Bytes schema_records_;                       // these two begin every chunk
  Bytes channel_records_;

  std::size_t length_bytes_ = 0;     // of the open chunk
  std::size_t committed_bytes_ = 0;  // of it, known to crc_
  std::uint32_t crc_ = 0;
  std::vector<IndexEntry> open_index_;

  std::uint64_t chunk_count_ = 0;
  std::deque<ChunkEntry> chunk_entries_;
  std::deque<ChannelOffset> channel_offsets_;
  Bytes metadata_indexes_;  // records
  Bytes attachment_indexes_;
  std::uint32_t metadata_count_ = 0;
  std::uint32_t attachment_count_ = 0;
  std::uint64_t first_ns_ = 0;
  std::uint64_t last_ns_ = 0;
};

}  // namespace lsv::mcap
