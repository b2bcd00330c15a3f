// SPDX-License-Identifier: BSD-3-Clause
// A small file with everything in it that a recording has, and what reading one gives.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

#include "lsv/mcap/reader.h"
#include "lsv/mcap/writer.h"
#include "tests/lsv/mcap/memory_sink.h"

namespace lsv::test {

/// A message that keeps its payload.
struct Said {
  std::string topic;
  std::uint32_t sequence = 0;
  std::int64_t log_time_ns = 0;
  std::string payload;
  friend bool operator==(const Said&, const Said&) = default;
  friend void PrintTo(const Said& said, std::ostream* out) { *out << said.sequence; }
};

inline mcap::Channel channel(const std::string& topic, const std::string& recording = "r1") {
  return {.topic = topic,
          .message_encoding = "cdr",
          .metadata = {{"recording", recording}},
          .schema = {.name = "lsv_msgs/msg/" + topic, .encoding = "ros2msg", .text = "int64 a\n"}};
}

inline const mcap::Metadata kNote{.name = "note", .entries = {{"a", "1"}, {"b", ""}}};
inline const mcap::Attachment kMap{.name = "map.tif",
                                   .media_type = "image/tiff",
                                   .log_time_ns = 5,
                                   .data = mcap::Bytes(9, std::byte{7})};

inline Said said(std::uint32_t i) {
  return {.topic = i % 3 == 0 ? "step" : "image",
          .sequence = i,
          .log_time_ns = 1000 + 10 * static_cast<std::int64_t>(i),
          .payload = std::string(5 + i % 7, static_cast<char>('a' + i % 26))};
}

/// Writes said(0) .. said(count - 1), each call until it succeeds; `mend` is told of a failure.
template <typename Mend>
mcap::Writer write_small(MemoryDisk& disk, std::uint32_t count, const mcap::WriterOptions& options,
                         Mend mend, const std::string& recording = "r1") {
  const auto until_ok = [&mend](auto call) {
    for (;;) {
      auto result = call();
      if (!result.ok())
        mend(result.error());
      else if constexpr (std::is_same_v<decltype(result), Result<void>>)
        return;
      else
        return std::move(result).value();
    }
  };
  mcap::Writer writer = until_ok([&] {
    disk.bytes.clear();
    return mcap::Writer::create(std::make_unique<MemorySink>(disk),
                                std::make_unique<mcap::HeapChunk>(400), options);
  });
  const mcap::ChannelId image =
      until_ok([&] { return writer.add_channel(channel("image", recording)); });
  const mcap::ChannelId step =
      until_ok([&] { return writer.add_channel(channel("step", recording)); });
  until_ok([&] { return writer.add_metadata(kNote); });
  until_ok([&] { return writer.add_attachment(kMap); });
  for (std::uint32_t i = 0; i < count; ++i) {
    const Said each = said(i);
    until_ok([&] {
      return writer.write({.channel = each.topic == "image" ? image : step,
                           .sequence = each.sequence,
                           .log_time_ns = each.log_time_ns,
                           .publish_time_ns = each.log_time_ns},
                          mcap::bytes_of(each.payload));
    });
  }
  return writer;
}

/// A file that was closed well.
inline mcap::Bytes small_file(std::uint32_t count, mcap::Compression compression) {
  MemoryDisk disk;
  mcap::Writer writer =
      write_small(disk, count, {.compression = compression}, [](const Error&) { std::abort(); });
  if (!writer.finish().ok()) std::abort();
  return disk.bytes;
}

/// The same file as written by a program that computes no CRCs.
inline mcap::Bytes without_crcs(mcap::Bytes file) {
  std::size_t at = mcap::kMagic.size();
  while (at + mcap::kRecordHead_bytes < file.size()) {
    mcap::ByteReader in(mcap::ByteView(file).subspan(at));
    const auto opcode = static_cast<mcap::Opcode>(in.number<std::uint8_t>());
    const auto content = in.number<std::uint64_t>();
    const std::size_t start = at + mcap::kRecordHead_bytes;
    const auto clear = [&](std::size_t offset) {
      std::fill_n(file.begin() + static_cast<std::ptrdiff_t>(start + offset), 4, std::byte{0});
    };
    if (opcode == mcap::Opcode::chunk) clear(24);
    if (opcode == mcap::Opcode::data_end) clear(0);
    if (opcode == mcap::Opcode::footer) clear(16);
    at = start + static_cast<std::size_t>(content);
  }
  return file;
}

struct ReadBack {
  std::vector<Said> messages;
  std::vector<mcap::Metadata> metadata;
  std::vector<mcap::Attachment> attachments;
  mcap::FileCondition condition;
  std::string error;  // empty when the end was reached
};

inline ReadBack read_all(mcap::Bytes bytes, mcap::Damage damage) {
  ReadBack out;
  Result<mcap::Reader> reader =
      mcap::Reader::open(mcap::memory_source("rec.mcap", std::move(bytes)), damage);
  if (!reader) {
    out.error = reader.error().message;
    return out;
  }
  for (;;) {
    const Result<mcap::Item> item = reader.value().next();
    out.condition = reader.value().condition();
    if (!item) {
      out.error = item.error().message;
      return out;
    }
    switch (item.value()) {
      case mcap::Item::message: {
        const mcap::Message& message = reader.value().message();
        out.messages.push_back({.topic = message.channel->topic,
                                .sequence = message.sequence,
                                .log_time_ns = message.log_time_ns,
                                .payload = std::string(mcap::text_of(message.payload))});
        break;
      }
      case mcap::Item::metadata:
        out.metadata.push_back(reader.value().metadata());
        break;
      case mcap::Item::attachment:
        out.attachments.push_back(reader.value().attachment());
        break;
      case mcap::Item::end:
        return out;
    }
  }
}

}  // namespace lsv::test
