// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/recover.h"

#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "lsv/mcap/crc32.h"
#include "lsv/mcap/tail.h"
#include "lsv/mcap/writer.h"

namespace lsv::mcap {
namespace {

constexpr std::size_t kChunk_bytes = std::size_t{4} << 20;

/// Writes what the reader hands out, until its end.
class Copy {
 public:
  Copy(Reader& from, Writer& to) : from_(from), to_(to) {}

  Result<void> run() {
    for (;;) {
      const Result<Item> item = from_.next();
      if (!item) return item.error();
      if (item.value() == Item::end) return {};
      ++items_;
      if (Result<void> copied = copy(item.value()); !copied) return copied;
    }
  }

  std::uint64_t items() const { return items_; }
  std::uint64_t messages() const { return messages_; }
  const std::map<std::string, std::uint64_t>& by_topic() const { return by_topic_; }

 private:
  Result<void> copy(Item item) {
    if (item == Item::metadata) return to_.add_metadata(from_.metadata());
    if (item == Item::attachment) return to_.add_attachment(from_.attachment());
    const Message& message = from_.message();
    auto channel = channels_.find(message.channel_id);
    if (channel == channels_.end()) {
      const Result<ChannelId> added = to_.add_channel(*message.channel);
      if (!added) return added.error();
      channel = channels_.emplace(message.channel_id, added.value()).first;
    }
    ++messages_;
    ++by_topic_[message.channel->topic];
    return to_.write({.channel = channel->second,
                      .sequence = message.sequence,
                      .log_time_ns = message.log_time_ns,
                      .publish_time_ns = message.publish_time_ns},
                     message.payload);
  }

  Reader& from_;
  Writer& to_;
  std::map<std::uint16_t, ChannelId> channels_;
  std::uint64_t items_ = 0;
  std::uint64_t messages_ = 0;
  std::map<std::string, std::uint64_t> by_topic_;
};

/// The records of the tail, when they follow on what `reader` has read.
Result<void> add_tail(ByteSource& source, Reader& reader, Recovered& out) {
  Result<std::optional<TailContent>> read = read_tail(source);
  if (!read) return read.error();
  std::optional<TailContent>& tail = read.value();
  // Without the chunks that were found damaged.
  const std::uint64_t expected = reader.condition().chunks;
  out.end_unknown = true;
  if (!tail) {
    out.tail_refused = "it holds nothing whole";
  } else if (tail->chunk < expected ||
             (expected > 0 && crc32(tail->records) == reader.condition().last_chunk_crc)) {
    out.tail_refused = "the file has its chunk already";
    out.end_unknown = false;
  } else if (const Result<void> added = reader.add_chunk(std::move(tail->records)); !added) {
    out.tail_refused = added.error().message;
  } else {
    out.chunks_before_tail = tail->chunk - expected;
    out.end_unknown = false;
  }
  return {};
}

}  // namespace

Result<Recovered> recover(std::unique_ptr<ByteSource> file, std::unique_ptr<ByteSource> tail,
                          std::unique_ptr<ByteSink> to) {
  const std::string name = file->name();
  Result<Reader> reader = Reader::open(std::move(file), Damage::skip);
  if (!reader) return reader.error();
  Result<Writer> writer =
      Writer::create(std::move(to), std::make_unique<HeapChunk>(kChunk_bytes), {});
  if (!writer) return writer.error();
  Copy copy(reader.value(), writer.value());
  if (Result<void> copied = copy.run(); !copied) return copied.error();
  Recovered out{.file = reader.value().condition()};
  out.has_tail = tail != nullptr;
  out.end_unknown = !tail && !out.file.finished;
  if (tail && !out.file.finished) {
    const std::uint64_t before = copy.messages();
    if (Result<void> added = add_tail(*tail, reader.value(), out); !added) return added.error();
    if (Result<void> copied = copy.run(); !copied) return copied.error();
    out.tail_messages = copy.messages() - before;
  }
  out.messages = copy.messages();
  out.by_topic = copy.by_topic();
  if (copy.items() == 0) {
    return Error{ErrorCode::bad_input,
                 name + ": nothing of a recording is found in it; is it an MCAP file?"};
  }
  if (Result<void> finished = writer.value().finish(); !finished) return finished.error();
  return out;
}

Result<std::unique_ptr<ByteSource>> open_tail(const std::string& recording_path) {
  const std::string path = tail_path(recording_path);
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) return std::unique_ptr<ByteSource>();
  return open_file(path);
}

}  // namespace lsv::mcap
