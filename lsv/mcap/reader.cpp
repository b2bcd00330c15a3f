// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/reader.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "lsv/mcap/compression.h"
#include "lsv/mcap/crc32.h"

namespace lsv::mcap {
namespace {

constexpr std::uint64_t kFooter_bytes = kRecordHead_bytes + 20;
constexpr std::uint64_t kBlock_bytes = std::uint64_t{1} << 20;
/// The head of a chunk up to its records, with the longest name of a compression.
constexpr std::uint64_t kChunkStart_bytes = kRecordHead_bytes + 8 + 8 + 8 + 4 + 4 + 4 + 8;

struct RecordHead {
  std::uint8_t opcode = 0;
  std::uint64_t content_bytes = 0;
};

RecordHead record_head(ByteReader& in) {
  RecordHead head;
  head.opcode = in.number<std::uint8_t>();
  head.content_bytes = in.number<std::uint64_t>();
  return head;
}

std::optional<Entries> read_entries(ByteReader& in) {
  ByteReader list(in.bytes(in.number<std::uint32_t>()));
  Entries entries;
  while (in.ok() && list.ok() && !list.at_end()) {
    const std::string_view key = list.text();
    const std::string_view value = list.text();
    if (list.ok()) entries.emplace(key, value);
  }
  if (!in.ok() || !list.ok()) return std::nullopt;
  return entries;
}

std::optional<std::int64_t> read_time(ByteReader& in) {
  const auto ns = in.number<std::uint64_t>();
  if (ns > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
    return std::nullopt;
  return static_cast<std::int64_t>(ns);
}

bool is_message_index(ByteView content) {
  ByteReader in(content);
  in.number<std::uint16_t>();
  in.bytes(in.number<std::uint32_t>());
  return in.ok() && in.at_end();
}

bool is_magic(ByteView bytes) {
  return std::equal(bytes.begin(), bytes.end(), kMagic.begin(), kMagic.end());
}

}  // namespace

Reader::Reader(std::unique_ptr<ByteSource> source, Damage damage)
    : source_(std::move(source)),
      damage_(damage),
      search_budget_bytes_(kMaxRecord_bytes + 8 * source_->size_bytes()) {}

Error Reader::wrong(const std::string& what) const {
  return {ErrorCode::bad_input,
          source_->name() + ": at byte " + std::to_string(offset_bytes_) + ": " + what +
              (damage_ == Damage::refuse ? "; lsv recover saves what is sound" : "")};
}

Result<Reader> Reader::open(std::unique_ptr<ByteSource> source, Damage damage) {
  Reader reader(std::move(source), damage);
  const Result<void> checked = reader.check_magic();
  if (!checked) {
    if (const Result<bool> found = reader.skip_damage(checked.error()); !found)
      return found.error();
  }
  return reader;
}

Result<void> Reader::check_magic() {
  const std::uint64_t size_bytes = source_->size_bytes();
  std::array<std::byte, kMagic.size()> magic{};
  if (size_bytes < magic.size())
    return Error{ErrorCode::bad_input, source_->name() + ": is not an MCAP file"};
  if (Result<void> read = source_->read(0, magic); !read) return read;
  if (!is_magic(magic))
    return Error{ErrorCode::bad_input, source_->name() + ": is not an MCAP file"};
  file_crc_ = crc32(magic);
  offset_bytes_ = magic.size();
  condition_.sound_bytes = offset_bytes_;
  if (damage_ == Damage::skip) return {};
  if (Result<void> read = source_->read(size_bytes - magic.size(), magic); !read) return read;
  if (size_bytes < 2 * magic.size() || !is_magic(magic)) {
    return Error{ErrorCode::bad_input,
                 source_->name() +
                     ": was never closed, or its end is lost; lsv recover saves what is sound"};
  }
  return {};
}

Result<Item> Reader::next() {
  for (;;) {
    if (next_in_chunk()) return Item::message;
    if (at_end_) return Item::end;
    Item item = Item::end;
    const Result<bool> taken = next_in_file(item);
    if (taken) {
      if (taken.value()) return item;
      continue;
    }
    const Result<bool> skipped = skip_damage(taken.error());
    if (!skipped) return skipped.error();
  }
}

/// Whether there is an item to hand out at once.
Result<bool> Reader::next_in_file(Item& item) {
  if (offset_bytes_ == source_->size_bytes() && damage_ == Damage::skip) {
    at_end_ = true;
    return false;
  }
  const Result<Record> record = read_record(offset_bytes_);
  if (!record) return record.error();
  Result<bool> taken = take(record.value(), item);
  if (!taken) return taken.error();
  if (at_end_) return taken;
  offset_bytes_ += record.value().size_bytes;
  condition_.sound_bytes = offset_bytes_;
  return taken;
}

Result<Reader::Record> Reader::read_record(std::uint64_t offset_bytes) {
  const std::uint64_t left_bytes = source_->size_bytes() - offset_bytes;
  if (left_bytes < kRecordHead_bytes) return wrong("the file ends inside a record");
  std::array<std::byte, kRecordHead_bytes> raw{};
  if (Result<void> read = source_->read(offset_bytes, raw); !read) return read.error();
  ByteReader in(raw);
  const RecordHead head = record_head(in);
  if (head.opcode == 0) return wrong("there is no record");
  if (head.content_bytes > left_bytes - kRecordHead_bytes)
    return wrong("the file ends inside a record");
  if (head.content_bytes > kMaxRecord_bytes) {
    return wrong("a record of " + std::to_string(head.content_bytes) +
                 " bytes is larger than lsv reads");
  }
  record_.resize(static_cast<std::size_t>(head.content_bytes));
  if (Result<void> read = source_->read(offset_bytes + kRecordHead_bytes, record_); !read)
    return read.error();
  // What ends the data is not part of them.
  if (file_crc_known_ && head.opcode != static_cast<std::uint8_t>(Opcode::data_end))
    file_crc_ = crc32(record_, crc32(raw, file_crc_));
  return Record{.opcode = Opcode{head.opcode},
                .size_bytes = kRecordHead_bytes + head.content_bytes,
                .content = record_};
}

Result<bool> Reader::take(const Record& record, Item& item) {
  const auto hand_out = [&item](const Result<void>& taken, Item kind) -> Result<bool> {
    if (!taken) return taken.error();
    item = kind;
    return true;
  };
  switch (record.opcode) {
    case Opcode::schema:
    case Opcode::channel:
      if (Result<void> taken = take_definition(record.opcode, record.content); !taken)
        return taken.error();
      return false;
    case Opcode::message:
      // Without a CRC of its own, so it is trusted only where the file has no chunks.
      if (damage_ == Damage::skip && condition_.chunks > 0)
        return wrong("a message lies outside of the chunks");
      return hand_out(take_message(record.content), Item::message);
    case Opcode::metadata:
      return hand_out(take_metadata(record.content), Item::metadata);
    case Opcode::attachment:
      return hand_out(take_attachment(record.content), Item::attachment);
    case Opcode::chunk:
      if (Result<void> taken = take_chunk(record.content); !taken) return taken.error();
      return false;
    case Opcode::data_end:
      if (Result<void> ended = check_end(record.content, offset_bytes_ + record.size_bytes); !ended)
        return ended.error();
      condition_.finished = true;
      condition_.sound_bytes = source_->size_bytes();
      at_end_ = true;
      return false;
    case Opcode::footer:
      return wrong("the file ends without an end of its data");
    case Opcode::header:
      return false;
    case Opcode::message_index:
      if (!is_message_index(record.content)) return wrong("an index is malformed");
      return false;
    default:
      // To be passed over, unless a flipped bit may have made one of these of a chunk.
      if (damage_ == Damage::skip) return wrong("a record is of an unknown kind");
      return false;
  }
}

/// Later versions of the format may add fields at the end; so may damage, where no CRC is checked.
bool Reader::read_whole(const ByteReader& in) const {
  return in.ok() && (in.at_end() || damage_ == Damage::refuse);
}

Result<void> Reader::take_definition(Opcode opcode, ByteView content) {
  return opcode == Opcode::schema ? take_schema(content) : take_channel(content);
}

Result<void> Reader::take_schema(ByteView content) {
  ByteReader in(content);
  const auto id = in.number<std::uint16_t>();
  const std::string_view name = in.text();
  const std::string_view encoding = in.text();
  const std::string_view text = in.text();
  if (!read_whole(in) || id == 0) return wrong("a schema is malformed");
  const auto known = schemas_.find(id);
  if (known == schemas_.end()) {
    schemas_.emplace(id, Schema{.name = std::string(name),
                                .encoding = std::string(encoding),
                                .text = std::string(text)});
    return {};
  }
  const Schema& before = known->second;
  if (before.name != name || before.encoding != encoding || before.text != text)
    return wrong("the schema " + before.name + " is defined anew");
  return {};
}

Result<void> Reader::take_channel(ByteView content) {
  ByteReader in(content);
  const auto id = in.number<std::uint16_t>();
  const auto schema_id = in.number<std::uint16_t>();
  Channel channel;
  channel.topic = in.text();
  channel.message_encoding = in.text();
  std::optional<Entries> entries = read_entries(in);
  if (!read_whole(in) || !entries) return wrong("a channel is malformed");
  channel.metadata = std::move(*entries);
  if (schema_id != 0) {
    const auto schema = schemas_.find(schema_id);
    if (schema == schemas_.end())
      return wrong("the schema of the channel " + channel.topic + " is missing");
    channel.schema = schema->second;
  }
  const auto known = channels_.find(id);
  if (known == channels_.end()) {
    channels_.emplace(id, std::make_unique<Channel>(std::move(channel)));
  } else if (*known->second != channel) {
    return wrong("the channel " + channel.topic + " is defined anew, as in another recording");
  }
  return {};
}

Result<void> Reader::take_message(ByteView content) {
  ByteReader in(content);
  Message message;
  message.channel_id = in.number<std::uint16_t>();
  message.sequence = in.number<std::uint32_t>();
  const std::optional<std::int64_t> log_time_ns = read_time(in);
  const std::optional<std::int64_t> publish_time_ns = read_time(in);
  if (!in.ok() || !log_time_ns || !publish_time_ns) return wrong("a message is malformed");
  const auto channel = channels_.find(message.channel_id);
  if (channel == channels_.end())
    return wrong("a message belongs to an unknown channel " + std::to_string(message.channel_id));
  message.channel = channel->second.get();
  message.log_time_ns = *log_time_ns;
  message.publish_time_ns = *publish_time_ns;
  message.payload = content.subspan(kMessageHead_bytes);
  message_ = message;
  return {};
}

Result<void> Reader::take_metadata(ByteView content) {
  ByteReader in(content);
  Metadata metadata;
  metadata.name = in.text();
  std::optional<Entries> entries = read_entries(in);
  if (!read_whole(in) || !entries) return wrong("a metadata record is malformed");
  metadata.entries = std::move(*entries);
  metadata_ = std::move(metadata);
  return {};
}

Result<void> Reader::take_attachment(ByteView content) {
  ByteReader in(content);
  Attachment attachment;
  const std::optional<std::int64_t> log_time_ns = read_time(in);
  in.number<std::uint64_t>();  // when it was made
  attachment.name = in.text();
  attachment.media_type = in.text();
  const ByteView data = in.bytes(in.number<std::uint64_t>());
  const std::size_t crc_bytes = in.position();
  const auto crc = in.number<std::uint32_t>();
  if (!read_whole(in) || !log_time_ns) return wrong("an attachment is malformed");
  if (crc != 0 && crc != crc32(content.first(crc_bytes)))
    return wrong("the attachment " + attachment.name + " is damaged");
  attachment.log_time_ns = *log_time_ns;
  attachment.data.assign(data.begin(), data.end());
  attachment_ = std::move(attachment);
  return {};
}

namespace {

template <typename Head>
bool read_chunk_head(ByteReader& in, Head& head) {
  in.bytes(16);  // first and last time: the messages tell
  head.plain_bytes = in.number<std::uint64_t>();
  head.plain_crc = in.number<std::uint32_t>();
  head.compression = in.text();
  return in.ok();
}

}  // namespace

Result<void> Reader::take_chunk(ByteView content) {
  ByteReader in(content);
  ChunkHead head;
  read_chunk_head(in, head);
  head.stored = in.bytes(in.number<std::uint64_t>());
  if (!read_whole(in)) return wrong("a chunk is malformed");
  const Result<ByteView> records = plain_records(head);
  if (!records) return records.error();
  if (Result<void> checked = check_records(records.value()); !checked) return checked;
  chunk_ = records.value();
  ++condition_.chunks;
  condition_.last_chunk_crc = head.plain_crc;
  return {};
}

Result<void> Reader::add_chunk(Bytes records) {
  if (Result<void> checked = check_records(records); !checked) return checked;
  record_ = std::move(records);
  chunk_ = record_;
  return {};
}

Result<ByteView> Reader::plain_records(const ChunkHead& head) {
  const std::optional<Compression> compression = compression_from(head.compression);
  if (!compression) {
    return wrong("a chunk is compressed with \"" + std::string(head.compression.substr(0, 16)) +
                 "\", but lsv reads only zstd");
  }
  ByteView plain = head.stored;
  if (compression == Compression::zstd) {
    if (head.plain_bytes > kMaxRecord_bytes) return wrong("a chunk is larger than lsv reads");
    const auto plain_bytes = static_cast<std::size_t>(head.plain_bytes);
    if (!may_unpack_to(head.stored, plain_bytes)) return wrong("a chunk is damaged");
    decompressed_.resize(plain_bytes);
    if (!decompress_zstd(head.stored, decompressed_)) return wrong("a chunk is damaged");
    plain = decompressed_;
  }
  if (plain.size() != head.plain_bytes || (head.plain_crc != 0 && head.plain_crc != crc32(plain)))
    return wrong("a chunk is damaged");
  return plain;
}

/// All of a chunk is known to be sound before any of it is handed out.
Result<void> Reader::check_records(ByteView records) {
  ByteReader in(records);
  while (!in.at_end()) {
    const RecordHead head = record_head(in);
    const ByteView content = in.bytes(head.content_bytes);
    if (!in.ok()) return wrong("a chunk ends inside a record");
    Result<void> taken;
    if (head.opcode == static_cast<std::uint8_t>(Opcode::message))
      taken = take_message(content);
    else if (head.opcode == static_cast<std::uint8_t>(Opcode::schema) ||
             head.opcode == static_cast<std::uint8_t>(Opcode::channel))
      taken = take_definition(Opcode{head.opcode}, content);
    if (!taken) return taken;
  }
  return {};
}

bool Reader::next_in_chunk() {
  while (!chunk_.empty()) {
    ByteReader in(chunk_);
    const RecordHead head = record_head(in);
    const ByteView content = in.bytes(head.content_bytes);
    chunk_ = chunk_.subspan(in.position());
    if (head.opcode == static_cast<std::uint8_t>(Opcode::message) && take_message(content).ok())
      return true;
  }
  return false;
}

Result<void> Reader::check_end(ByteView data_end, std::uint64_t end_bytes) {
  ByteReader in(data_end);
  const auto data_crc = in.number<std::uint32_t>();
  if (!read_whole(in)) return wrong("the end of the data is malformed");
  if (data_crc != 0 && file_crc_known_ && data_crc != file_crc_)
    return wrong("the data do not have the CRC that they had when the file was closed");
  const std::uint64_t size_bytes = source_->size_bytes();
  constexpr std::uint64_t kEnd_bytes = kFooter_bytes + kMagic.size();
  if (size_bytes - end_bytes < kEnd_bytes) return wrong("the file ends inside its summary");
  std::array<std::byte, kEnd_bytes> raw{};
  const std::uint64_t footer_bytes = size_bytes - kEnd_bytes;
  if (Result<void> read = source_->read(footer_bytes, raw); !read) return read;
  ByteReader footer(raw);
  const RecordHead head = record_head(footer);
  const auto summary_start_bytes = footer.number<std::uint64_t>();
  footer.number<std::uint64_t>();
  const auto summary_crc = footer.number<std::uint32_t>();
  if (head.opcode != static_cast<std::uint8_t>(Opcode::footer) || head.content_bytes != 20 ||
      !is_magic(ByteView(raw).last(kMagic.size())))
    return wrong("the file ends without a footer");
  if (summary_start_bytes != 0 && summary_start_bytes != end_bytes)
    return wrong("the footer does not fit the file");
  if (summary_crc == 0) return {};
  const Result<std::uint32_t> crc =
      crc_of_file(end_bytes, size_bytes - kMagic.size() - sizeof summary_crc);
  if (!crc) return crc.error();
  if (crc.value() != summary_crc) return wrong("the summary is damaged");
  return {};
}

Result<std::uint32_t> Reader::crc_of_file(std::uint64_t from_bytes, std::uint64_t to_bytes) {
  std::uint32_t crc = 0;
  Bytes block;
  while (from_bytes < to_bytes) {
    block.resize(static_cast<std::size_t>(std::min(kBlock_bytes, to_bytes - from_bytes)));
    if (Result<void> read = source_->read(from_bytes, block); !read) return read.error();
    crc = crc32(block, crc);
    from_bytes += block.size();
  }
  return crc;
}

/// Whether there is more to read.
Result<bool> Reader::skip_damage(const Error& error) {
  if (damage_ == Damage::refuse) {
    at_end_ = true;
    chunk_ = {};
    return error;
  }
  if (condition_.damages++ == 0) condition_.first_damage = error.message;
  file_crc_known_ = false;
  Result<bool> found = find_chunk(offset_bytes_ + 1);
  at_end_ = !found || !found.value();
  condition_.torn_end = at_end_;
  return found;
}

Result<bool> Reader::find_chunk(std::uint64_t from_bytes) {
  const std::uint64_t size_bytes = source_->size_bytes();
  Bytes window;
  while (from_bytes + kRecordHead_bytes < size_bytes) {
    window.resize(static_cast<std::size_t>(
        std::min(kBlock_bytes + kChunkStart_bytes, size_bytes - from_bytes)));
    if (Result<void> read = source_->read(from_bytes, window); !read) return read.error();
    const auto block_bytes = std::min<std::uint64_t>(kBlock_bytes, window.size());
    for (std::uint64_t i = 0; i < block_bytes; ++i) {
      if (!is_sound_chunk(from_bytes + i, ByteView(window).subspan(static_cast<std::size_t>(i))))
        continue;
      offset_bytes_ = from_bytes + i;
      return true;
    }
    from_bytes += block_bytes;
  }
  return false;
}

bool Reader::is_sound_chunk(std::uint64_t offset_bytes, ByteView start) {
  if (start.front() != static_cast<std::byte>(Opcode::chunk)) return false;
  ByteReader in(start);
  const RecordHead record = record_head(in);
  if (record.content_bytes > kMaxRecord_bytes ||
      record.content_bytes > source_->size_bytes() - offset_bytes)
    return false;
  ChunkHead head;
  if (!read_chunk_head(in, head) || !compression_from(head.compression)) return false;
  const auto stored_bytes = in.number<std::uint64_t>();
  if (!in.ok() || head.plain_crc == 0 || stored_bytes > record.content_bytes ||
      in.position() - kRecordHead_bytes + stored_bytes != record.content_bytes)
    return false;
  // Chunks that lie in each other would otherwise take time with the square of the file.
  if (record.content_bytes > search_budget_bytes_) return false;
  search_budget_bytes_ -= record.content_bytes;
  const Result<Record> read = read_record(offset_bytes);
  if (!read) return false;
  head.stored = read.value().content.last(static_cast<std::size_t>(stored_bytes));
  return plain_records(head).ok();
}

}  // namespace lsv::mcap
