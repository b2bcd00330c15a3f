// SPDX-License-Identifier: BSD-3-Clause
// Little-endian numbers, texts and byte runs in memory, as MCAP and CDR store them.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lsv::mcap {

static_assert(std::endian::native == std::endian::little,
              "numbers and 16-bit pixels are copied as they lie in memory");

using Bytes = std::vector<std::byte>;
using ByteView = std::span<const std::byte>;

template <typename T>
concept Number = std::is_arithmetic_v<T>;

inline ByteView bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}
inline std::string_view text_of(ByteView bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Appends to a buffer of the caller.
class ByteWriter {
 public:
  explicit ByteWriter(Bytes& out) : out_(out) {}

  template <Number T>
  void number(T value) {
    bytes({reinterpret_cast<const std::byte*>(&value), sizeof value});
  }
  void bytes(ByteView bytes) {
    const std::size_t at = out_.size();
    out_.resize(at + bytes.size());
    if (!bytes.empty()) std::memcpy(out_.data() + at, bytes.data(), bytes.size());
  }
  /// A text behind its length.
  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    bytes(bytes_of(text));
  }
  std::size_t size() const { return out_.size(); }
  /// Overwrites what number() wrote at `position`.
  template <Number T>
  void number_at(std::size_t position, T value) {
    std::memcpy(out_.data() + position, &value, sizeof value);
  }

 private:
  Bytes& out_;
};

/// Reads within bounds: past the end every answer is 0 or empty and ok() stays false.
class ByteReader {
 public:
  explicit ByteReader(ByteView in) : in_(in) {}

  template <Number T>
  T number() {
    T value{};
    const ByteView raw = bytes(sizeof value);
    if (raw.size() == sizeof value) std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  ByteView bytes(std::uint64_t count) {
    if (!ok_ || count > in_.size() - position_) {
      ok_ = false;
      return {};
    }
    const ByteView out = in_.subspan(position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return out;
  }
  std::string_view text() { return text_of(bytes(number<std::uint32_t>())); }

  bool ok() const { return ok_; }
  bool at_end() const { return position_ == in_.size(); }
  std::size_t position() const { return position_; }

 private:
  ByteView in_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace lsv::mcap
