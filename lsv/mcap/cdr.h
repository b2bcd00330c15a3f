// SPDX-License-Identifier: BSD-3-Clause
// The byte layout of ROS 2 messages: plain CDR, little-endian, each number at a multiple of its
// size from the start of the body.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "lsv/mcap/bytes.h"

namespace lsv::mcap {

/// Overwrites a buffer of the caller with one message; its memory is kept.
class CdrWriter {
 public:
  explicit CdrWriter(Bytes& out) : bytes_(out), out_(out) {
    out.clear();
    out_.number(kPlainLittleEndian);
  }

  template <Number T>
  void number(T value) {
    align(sizeof value);
    out_.number(value);
  }
  /// With its end mark, as CDR has it.
  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size() + 1));
    out_.bytes(bytes_of(text));
    out_.number(std::uint8_t{0});
  }
  /// Without a length: raw() after number(count) is a sequence of bytes.
  void raw(ByteView bytes) { out_.bytes(bytes); }

 private:
  static constexpr std::uint32_t kPlainLittleEndian = 0x00000100;  // the bytes 00 01 00 00
  static constexpr std::size_t kBodyAt_bytes = 4;
  void align(std::size_t size) {
    while ((bytes_.size() - kBodyAt_bytes) % size != 0) out_.number(std::uint8_t{0});
  }

  Bytes& bytes_;
  ByteWriter out_;
};

/// Within bounds, like ByteReader.
class CdrReader {
 public:
  explicit CdrReader(ByteView message) : in_(message) {
    const ByteView head = in_.bytes(kBodyAt_bytes);
    is_cdr_ = in_.ok() && head[0] == std::byte{0} && head[1] == std::byte{1};
  }

  template <Number T>
  T number() {
    const std::size_t past = (in_.position() - kBodyAt_bytes) % sizeof(T);
    if (ok() && past != 0) in_.bytes(sizeof(T) - past);
    return in_.number<T>();
  }
  bool boolean() { return number<std::uint8_t>() != 0; }
  std::string_view text() {
    const auto size = number<std::uint32_t>();
    const std::string_view text = text_of(in_.bytes(size));
    // Some writers leave an empty text without an end mark.
    return text.empty() ? text : text.substr(0, text.size() - 1);
  }
  ByteView raw(std::size_t count) { return in_.bytes(count); }

  bool ok() const { return is_cdr_ && in_.ok(); }

 private:
  static constexpr std::size_t kBodyAt_bytes = 4;
  ByteReader in_;
  bool is_cdr_ = false;
};

}  // namespace lsv::mcap
