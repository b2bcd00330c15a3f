// SPDX-License-Identifier: BSD-3-Clause
// PGM, binary (P5, 16-bit words big-endian) and text (P2), as netpbm's pgm(5) describes them.
#include <limits>
#include <optional>

#include "lsv/ingest/decoders.h"

namespace lsv {
namespace {

bool is_space(std::uint8_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_digit(std::uint8_t c) { return c >= '0' && c <= '9'; }

/// Walks over white space, comments and unsigned numbers.
class Scanner {
 public:
  explicit Scanner(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  /// The next number, which must be followed by white space. Not consumed: that one byte.
  std::optional<int> number() {
    skip_blank();
    const std::size_t begin = at_;
    int value = 0;
    while (at_ < bytes_.size() && is_digit(bytes_[at_])) {
      const int digit = bytes_[at_] - '0';
      if (value > (std::numeric_limits<int>::max() - digit) / 10) return std::nullopt;
      value = value * 10 + digit;
      ++at_;
    }
    if (at_ == begin || at_ == bytes_.size() || !is_space(bytes_[at_])) return std::nullopt;
    return value;
  }

  void skip(std::size_t count) { at_ += count; }
  std::span<const std::uint8_t> rest() const { return bytes_.subspan(at_); }

  bool only_blank_left() {
    skip_blank();
    return at_ == bytes_.size();
  }

 private:
  void skip_blank() {
    bool in_comment = false;
    for (; at_ < bytes_.size(); ++at_) {
      const std::uint8_t c = bytes_[at_];
      if (in_comment) {
        in_comment = c != '\n' && c != '\r';
      } else if (c == '#') {
        in_comment = true;
      } else if (!is_space(c)) {
        return;
      }
    }
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

struct Header {
  FrameFormat format;
  int max_value = 0;
};

Result<Header> read_header(const EncodedImage& in, Scanner& scanner) {
  const auto width = scanner.number();
  const auto height = width ? scanner.number() : std::nullopt;
  const auto max_value = height ? scanner.number() : std::nullopt;
  if (!max_value) return bad_image(in.name, "PGM header is not `P5 width height maxval`");
  const auto size = check_image_size(in.name, *width, *height, in.options.max_pixels);
  if (!size) return size.error();
  if (*max_value < 1 || *max_value > 65535) {
    return bad_image(
        in.name, "PGM maxval is " + std::to_string(*max_value) + " but must be from 1 to 65535");
  }
  Header header{.format = {.width_px = *width, .height_px = *height}, .max_value = *max_value};
  if (*max_value > 255) {
    header.format.type = PixelType::mono16;
    header.format.bit_depth = in.options.bit_depth.value_or(bit_depth_for(*max_value));
  }
  return header;
}

Error above_maxval(const EncodedImage& in, int value, int max_value) {
  return bad_image(in.name, "has a pixel value of " + std::to_string(value) +
                                " above its maxval of " + std::to_string(max_value));
}

Result<ImageNotes> read_binary(const EncodedImage& in, const Header& header,
                               std::span<const std::uint8_t> data, Frame& out) {
  const auto width = static_cast<std::size_t>(header.format.width_px);
  const std::size_t needed = width * static_cast<std::size_t>(header.format.height_px) *
                             bytes_per_pixel(header.format.type);
  if (data.size() != needed) {
    return bad_image(in.name, "holds " + std::to_string(data.size()) +
                                  " bytes of pixels where its PGM header declares " +
                                  std::to_string(needed));
  }
  out.reset(header.format);
  const bool wide = header.format.type == PixelType::mono16;
  const std::uint8_t* from = data.data();
  for (int y = 0; y < header.format.height_px; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const int value = wide ? from[0] << 8 | from[1] : from[0];
      if (value > header.max_value) return above_maxval(in, value, header.max_value);
      if (wide) {
        out.row16(y)[x] = static_cast<std::uint16_t>(value);
      } else {
        out.row8(y)[x] = static_cast<std::uint8_t>(value);
      }
      from += wide ? 2 : 1;
    }
  }
  return ImageNotes{};
}

Result<ImageNotes> read_text(const EncodedImage& in, const Header& header, Scanner& scanner,
                             Frame& out) {
  const std::int64_t pixels =
      std::int64_t{header.format.width_px} * std::int64_t{header.format.height_px};
  if (static_cast<std::int64_t>(scanner.rest().size()) < 2 * pixels)
    return bad_image(in.name, "is too short for the size that its PGM header declares");
  out.reset(header.format);
  for (int y = 0; y < header.format.height_px; ++y) {
    for (int x = 0; x < header.format.width_px; ++x) {
      const auto value = scanner.number();
      if (!value) {
        return bad_image(in.name, "pixel at column " + std::to_string(x) + ", row " +
                                      std::to_string(y) +
                                      " is missing or is not a number followed by white space");
      }
      if (*value > header.max_value) return above_maxval(in, *value, header.max_value);
      if (header.format.type == PixelType::mono16) {
        out.row16(y)[x] = static_cast<std::uint16_t>(*value);
      } else {
        out.row8(y)[x] = static_cast<std::uint8_t>(*value);
      }
    }
  }
  if (!scanner.only_blank_left())
    return bad_image(in.name, "holds more pixels than its PGM header declares");
  return ImageNotes{};
}

}  // namespace

Result<ImageNotes> decode_pgm(const EncodedImage& in, Frame& out) {
  Scanner scanner(in.bytes);
  scanner.skip(2);  // the magic number, already checked
  const auto header = read_header(in, scanner);
  if (!header) return header.error();
  if (in.bytes[1] == '2') return read_text(in, header.value(), scanner, out);
  scanner.skip(1);  // exactly one white space ends a binary header
  return read_binary(in, header.value(), scanner.rest(), out);
}

}  // namespace lsv
