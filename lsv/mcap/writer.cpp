// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/writer.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "lsv/mcap/crc32.h"

namespace lsv::mcap {
namespace {

Error usage(std::string what) { return {ErrorCode::invalid_argument, std::move(what)}; }

void put_record(Bytes& out, Opcode opcode, ByteView content) {
  ByteWriter writer(out);
  writer.number(static_cast<std::uint8_t>(opcode));
  writer.number(static_cast<std::uint64_t>(content.size()));
  writer.bytes(content);
}

void put_entries(ByteWriter& out, const Entries& entries) {
  const std::size_t length_at = out.size();
  out.number(std::uint32_t{0});
  const std::size_t start = out.size();
  for (const auto& [key, value] : entries) {
    out.text(key);
    out.text(value);
  }
  out.number_at(length_at, static_cast<std::uint32_t>(out.size() - start));
}

Bytes channel_content(ChannelId id, std::uint16_t schema, const Channel& channel) {
  Bytes content;
  ByteWriter out(content);
  out.number(id);
  out.number(schema);
  out.text(channel.topic);
  out.text(channel.message_encoding);
  put_entries(out, channel.metadata);
  return content;
}

Bytes schema_content(std::uint16_t id, const Schema& schema) {
  Bytes content;
  ByteWriter out(content);
  out.number(id);
  out.text(schema.name);
  out.text(schema.encoding);
  out.text(schema.text);
  return content;
}

std::size_t records_bytes(std::size_t messages, std::size_t payload_bytes) {
  return messages * (kRecordHead_bytes + kMessageHead_bytes) + payload_bytes;
}

/// MCAP's times count from 0.
std::uint64_t time_of(std::int64_t ns) {
  return static_cast<std::uint64_t>(std::max(ns, std::int64_t{0}));
}

}  // namespace

Writer::Writer(std::unique_ptr<ByteSink> sink, std::unique_ptr<ChunkMemory> chunk,
               const WriterOptions& options)
    : sink_(std::move(sink)), chunk_(std::move(chunk)), compression_(options.compression) {}

Result<Writer> Writer::create(std::unique_ptr<ByteSink> sink, std::unique_ptr<ChunkMemory> chunk,
                              const WriterOptions& options) {
  Writer writer(std::move(sink), std::move(chunk), options);
  Bytes header;
  ByteWriter content(header);
  content.text(options.profile);
  content.text(options.library);
  Bytes start(kMagic.begin(), kMagic.end());
  put_record(start, Opcode::header, header);
  if (Result<void> written = writer.append(start); !written) return written.error();
  return writer;
}

/// All of it or, as far as the sink can cut, nothing.
Result<void> Writer::append(ByteView head, ByteView body, std::uint32_t body_crc, ByteView tail) {
  if (torn_) {
    if (Result<void> cut = sink_->truncate(static_cast<std::int64_t>(good_bytes_)); !cut)
      return cut;
    torn_ = false;
  }
  std::uint64_t size_bytes = 0;
  for (const ByteView part : {head, body, tail}) {
    if (Result<void> written = sink_->append(part); !written) {
      torn_ = !sink_->truncate(static_cast<std::int64_t>(good_bytes_)).ok();
      return written;
    }
    size_bytes += part.size();
  }
  good_bytes_ += size_bytes;
  file_crc_ = crc32_joined(crc32(head, file_crc_), body_crc, body.size());
  file_crc_ = crc32(tail, file_crc_);
  return {};
}

Result<std::uint64_t> Writer::append_record(Opcode opcode, ByteView content) {
  const std::uint64_t offset_bytes = good_bytes_;
  Bytes record;
  put_record(record, opcode, content);
  if (Result<void> written = append(record); !written) return written.error();
  return offset_bytes;
}

Result<ChannelId> Writer::add_channel(const Channel& channel) {
  if (message_counts_.size() >= std::numeric_limits<ChannelId>::max())
    return usage("a recording cannot hold more than 65534 channels");
  // The open chunk began without it.
  if (Result<void> flushed = flush(); !flushed) return flushed.error();
  const auto known = std::find(schemas_.begin(), schemas_.end(), channel.schema);
  // The number 0 means that there is no schema.
  const auto schema = static_cast<std::uint16_t>(known - schemas_.begin() + 1);
  if (known == schemas_.end()) {
    schemas_.push_back(channel.schema);
    put_record(schema_records_, Opcode::schema, schema_content(schema, channel.schema));
  }
  const auto id = static_cast<ChannelId>(message_counts_.size());
  message_counts_.push_back(0);
  put_record(channel_records_, Opcode::channel, channel_content(id, schema, channel));
  return id;
}

Result<void> Writer::add_metadata(const Metadata& metadata) {
  Bytes content;
  ByteWriter out(content);
  out.text(metadata.name);
  put_entries(out, metadata.entries);
  const Result<std::uint64_t> offset_bytes = append_record(Opcode::metadata, content);
  if (!offset_bytes) return offset_bytes.error();
  Bytes index;
  ByteWriter index_out(index);
  index_out.number(offset_bytes.value());
  index_out.number(good_bytes_ - offset_bytes.value());
  index_out.text(metadata.name);
  put_record(metadata_indexes_, Opcode::metadata_index, index);
  ++metadata_count_;
  return {};
}

Result<void> Writer::add_attachment(const Attachment& attachment) {
  Bytes content;
  ByteWriter out(content);
  out.number(time_of(attachment.log_time_ns));
  out.number(time_of(attachment.log_time_ns));
  out.text(attachment.name);
  out.text(attachment.media_type);
  out.number(static_cast<std::uint64_t>(attachment.data.size()));
  out.bytes(attachment.data);
  out.number(crc32(content));
  const Result<std::uint64_t> offset_bytes = append_record(Opcode::attachment, content);
  if (!offset_bytes) return offset_bytes.error();
  Bytes index;
  ByteWriter index_out(index);
  index_out.number(offset_bytes.value());
  index_out.number(good_bytes_ - offset_bytes.value());
  index_out.number(time_of(attachment.log_time_ns));
  index_out.number(time_of(attachment.log_time_ns));
  index_out.number(static_cast<std::uint64_t>(attachment.data.size()));
  index_out.text(attachment.name);
  index_out.text(attachment.media_type);
  put_record(attachment_indexes_, Opcode::attachment_index, index);
  ++attachment_count_;
  return {};
}

void Writer::start_chunk() {
  std::byte* const to = chunk_->bytes().data();
  std::memcpy(to, schema_records_.data(), schema_records_.size());
  std::memcpy(to + schema_records_.size(), channel_records_.data(), channel_records_.size());
  length_bytes_ = schema_records_.size() + channel_records_.size();
  committed_bytes_ = 0;
  crc_ = 0;
}

/// Room in an empty chunk, which an open one may lack.
bool Writer::may_hold(std::size_t size_bytes) {
  const std::size_t needed = schema_records_.size() + channel_records_.size() + size_bytes;
  constexpr std::size_t kMaxChunk_bytes = std::numeric_limits<std::int32_t>::max();
  return needed <= kMaxChunk_bytes && (needed <= chunk_->bytes().size() || chunk_->grow(needed));
}

bool Writer::has_room(std::size_t messages, std::size_t payload_bytes) const {
  return has_open_messages() &&
         length_bytes_ + records_bytes(messages, payload_bytes) <= chunk_->bytes().size();
}

Result<void> Writer::make_room(std::size_t messages, std::size_t payload_bytes) {
  if (has_room(messages, payload_bytes)) return {};
  if (Result<void> flushed = flush(); !flushed) return flushed;
  const std::size_t size_bytes = records_bytes(messages, payload_bytes);
  if (!may_hold(size_bytes)) {
    return usage(sink_->name() + ": messages of " + std::to_string(payload_bytes) +
                 " bytes do not fit into a chunk of " + std::to_string(chunk_->bytes().size()));
  }
  start_chunk();
  return {};
}

Result<void> Writer::write(const MessageHead& head, ByteView payload) {
  if (head.channel >= message_counts_.size())
    return usage(sink_->name() + ": there is no channel " + std::to_string(head.channel));
  if (Result<void> room = make_room(1, payload.size()); !room) return room;
  std::byte* to = chunk_->bytes().data() + length_bytes_;
  const auto put = [&to](auto value) {
    std::memcpy(to, &value, sizeof value);
    to += sizeof value;
  };
  const std::uint64_t log_time_ns = time_of(head.log_time_ns);
  put(static_cast<std::uint8_t>(Opcode::message));
  put(static_cast<std::uint64_t>(kMessageHead_bytes + payload.size()));
  put(head.channel);
  put(head.sequence);
  put(log_time_ns);
  put(time_of(head.publish_time_ns));
  if (!payload.empty()) std::memcpy(to, payload.data(), payload.size());
  open_index_.push_back(
      {.channel = head.channel, .log_time_ns = log_time_ns, .offset_bytes = length_bytes_});
  length_bytes_ += kRecordHead_bytes + kMessageHead_bytes + payload.size();
  return {};
}

void Writer::commit() {
  if (committed_bytes_ == length_bytes_ || !has_open_messages()) return;
  crc_ = crc32(
      ByteView(chunk_->bytes()).subspan(committed_bytes_, length_bytes_ - committed_bytes_), crc_);
  committed_bytes_ = length_bytes_;
  chunk_->commit(chunk_count_, length_bytes_, crc_);
}

void Writer::put_message_indexes(ChunkEntry& entry, std::vector<ChannelOffset>& offsets,
                                 Bytes& out) {
  std::stable_sort(open_index_.begin(), open_index_.end(),
                   [](const IndexEntry& a, const IndexEntry& b) { return a.channel < b.channel; });
  for (auto first = open_index_.begin(); first != open_index_.end();) {
    const auto last = std::find_if(first, open_index_.end(), [&](const IndexEntry& each) {
      return each.channel != first->channel;
    });
    offsets.push_back(
        {.channel = first->channel, .after_chunk_bytes = static_cast<std::uint32_t>(out.size())});
    Bytes content;
    ByteWriter index(content);
    index.number(first->channel);
    index.number(static_cast<std::uint32_t>((last - first) * 16));
    for (; first != last; ++first) {
      index.number(first->log_time_ns);
      index.number(first->offset_bytes);
      entry.first_ns = std::min(entry.first_ns, first->log_time_ns);
      entry.last_ns = std::max(entry.last_ns, first->log_time_ns);
    }
    put_record(out, Opcode::message_index, content);
  }
  entry.index_bytes = out.size();
  entry.channel_count = static_cast<std::uint32_t>(offsets.size());
}

Result<void> Writer::flush() {
  if (!has_open_messages()) return {};
  commit();
  const ByteView plain = ByteView(chunk_->bytes()).first(length_bytes_);
  ByteView stored = plain;
  if (compression_ == Compression::zstd) {
    Result<ByteView> packed = compressor_.compress(plain);
    if (!packed) return packed.error();
    stored = packed.value();
  }
  ChunkEntry entry{.offset_bytes = good_bytes_,
                   .first_ns = open_index_.front().log_time_ns,
                   .last_ns = 0,
                   .stored_bytes = static_cast<std::uint32_t>(stored.size()),
                   .plain_bytes = static_cast<std::uint32_t>(plain.size())};
  std::vector<ChannelOffset> offsets;
  Bytes indexes;
  put_message_indexes(entry, offsets, indexes);

  Bytes fields;
  ByteWriter chunk(fields);
  chunk.number(entry.first_ns);
  chunk.number(entry.last_ns);
  chunk.number(static_cast<std::uint64_t>(plain.size()));
  chunk.number(crc_);
  chunk.text(word(compression_));
  chunk.number(static_cast<std::uint64_t>(stored.size()));
  Bytes head;
  ByteWriter record(head);
  record.number(static_cast<std::uint8_t>(Opcode::chunk));
  record.number(static_cast<std::uint64_t>(fields.size() + stored.size()));
  record.bytes(fields);
  entry.length_bytes = static_cast<std::uint32_t>(head.size() + stored.size());
  const std::uint32_t stored_crc = compression_ == Compression::none ? crc_ : crc32(stored);
  if (Result<void> written = append(head, stored, stored_crc, indexes); !written) return written;

  if (chunk_count_ == 0) first_ns_ = entry.first_ns;
  first_ns_ = std::min(first_ns_, entry.first_ns);
  last_ns_ = std::max(last_ns_, entry.last_ns);
  for (const IndexEntry& each : open_index_) ++message_counts_[each.channel];
  chunk_entries_.push_back(entry);
  channel_offsets_.insert(channel_offsets_.end(), offsets.begin(), offsets.end());
  ++chunk_count_;
  open_index_.clear();
  return {};
}

Bytes Writer::statistics() const {
  Bytes content;
  ByteWriter out(content);
  std::uint64_t messages = 0;
  std::uint32_t used = 0;
  for (const std::uint64_t count : message_counts_) {
    messages += count;
    used += count > 0 ? 1U : 0U;
  }
  out.number(messages);
  out.number(static_cast<std::uint16_t>(schemas_.size()));
  out.number(static_cast<std::uint32_t>(message_counts_.size()));
  out.number(attachment_count_);
  out.number(metadata_count_);
  out.number(static_cast<std::uint32_t>(chunk_count_));
  out.number(first_ns_);
  out.number(last_ns_);
  out.number(used * 10);
  for (std::size_t channel = 0; channel < message_counts_.size(); ++channel) {
    if (message_counts_[channel] == 0) continue;
    out.number(static_cast<ChannelId>(channel));
    out.number(message_counts_[channel]);
  }
  return content;
}

Bytes Writer::chunk_index(const ChunkEntry& entry, std::size_t& next_offset) const {
  Bytes content;
  ByteWriter out(content);
  out.number(entry.first_ns);
  out.number(entry.last_ns);
  out.number(entry.offset_bytes);
  out.number(static_cast<std::uint64_t>(entry.length_bytes));
  out.number(entry.channel_count * 10);
  for (std::uint32_t i = 0; i < entry.channel_count; ++i) {
    const ChannelOffset& offset = channel_offsets_[next_offset++];
    out.number(offset.channel);
    out.number(entry.offset_bytes + entry.length_bytes + offset.after_chunk_bytes);
  }
  out.number(entry.index_bytes);
  out.text(word(compression_));
  out.number(static_cast<std::uint64_t>(entry.stored_bytes));
  out.number(static_cast<std::uint64_t>(entry.plain_bytes));
  return content;
}

/// Everything from the end of the data on.
Bytes Writer::end_of_file() {
  Bytes out;
  Bytes data_end;
  ByteWriter(data_end).number(file_crc_);
  put_record(out, Opcode::data_end, data_end);
  const std::uint64_t summary_at = out.size();
  Bytes offsets;
  const auto end_group = [&](Opcode opcode, std::uint64_t start) {
    if (out.size() == start) return;
    Bytes content;
    ByteWriter offset(content);
    offset.number(static_cast<std::uint8_t>(opcode));
    offset.number(good_bytes_ + start);
    offset.number(out.size() - start);
    put_record(offsets, Opcode::summary_offset, content);
  };
  const auto add_group = [&](Opcode opcode, ByteView records) {
    const std::uint64_t start = out.size();
    ByteWriter(out).bytes(records);
    end_group(opcode, start);
  };
  add_group(Opcode::schema, schema_records_);
  add_group(Opcode::channel, channel_records_);
  const std::uint64_t statistics_at = out.size();
  put_record(out, Opcode::statistics, statistics());
  end_group(Opcode::statistics, statistics_at);
  const std::uint64_t chunks_at = out.size();
  std::size_t next_offset = 0;
  for (const ChunkEntry& entry : chunk_entries_)
    put_record(out, Opcode::chunk_index, chunk_index(entry, next_offset));
  end_group(Opcode::chunk_index, chunks_at);
  add_group(Opcode::attachment_index, attachment_indexes_);
  add_group(Opcode::metadata_index, metadata_indexes_);
  const std::uint64_t offsets_at = out.size();

  ByteWriter footer(out);
  footer.bytes(offsets);
  footer.number(static_cast<std::uint8_t>(Opcode::footer));
  footer.number(std::uint64_t{20});
  footer.number(good_bytes_ + summary_at);
  footer.number(good_bytes_ + offsets_at);
  footer.number(crc32(ByteView(out).subspan(static_cast<std::size_t>(summary_at))));
  footer.bytes(kMagic);
  return out;
}

Result<void> Writer::finish() {
  if (Result<void> flushed = flush(); !flushed) return flushed;
  if (Result<void> written = append(end_of_file()); !written) return written;
  return sync();
}

}  // namespace lsv::mcap
