// SPDX-License-Identifier: BSD-3-Clause
// The building blocks of an MCAP file (https://mcap.dev/spec): what reader and writer share.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "lsv/mcap/bytes.h"

namespace lsv::mcap {

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

inline constexpr std::array kMagic = {std::byte{0x89}, std::byte{'M'}, std::byte{'C'},
                                      std::byte{'A'},  std::byte{'P'}, std::byte{'0'},
                                      std::byte{'\r'}, std::byte{'\n'}};

/// Opcode and length before the content of a record.
inline constexpr std::size_t kRecordHead_bytes = 9;
/// Channel, sequence and two times before the payload of a message.
inline constexpr std::size_t kMessageHead_bytes = 22;

using Entries = std::map<std::string, std::string, std::less<>>;

/// What the messages of a channel are: for ROS 2 the name of the type and its definition with those
/// of all types in it.
struct Schema {
  std::string name;
  std::string encoding;
  std::string text;
  friend bool operator==(const Schema&, const Schema&) = default;
};

struct Channel {
  std::string topic;
  std::string message_encoding;
  Entries metadata{};
  Schema schema{};
  friend bool operator==(const Channel&, const Channel&) = default;
};

struct Metadata {
  std::string name;
  Entries entries;
  friend bool operator==(const Metadata&, const Metadata&) = default;
};

struct Attachment {
  std::string name;
  std::string media_type;
  std::int64_t log_time_ns = 0;
  Bytes data;
  friend bool operator==(const Attachment&, const Attachment&) = default;
};

}  // namespace lsv::mcap
