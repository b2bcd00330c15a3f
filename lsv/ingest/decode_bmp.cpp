// SPDX-License-Identifier: BSD-3-Clause
// Uncompressed BMP of 8, 24 or 32 bits. OpenCV decodes; since it reads past lies in the header
// without a word, the header is checked against the length of the file first.
#include <cstdlib>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "lsv/ingest/decoders.h"

namespace lsv {
namespace {

constexpr std::size_t kHeaders_bytes = 14 + 40;

template <typename Word>
Word little_endian(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < sizeof(Word); ++i) value |= std::uint32_t{bytes[at + i]} << (8 * i);
  return static_cast<Word>(value);
}

/// Microsoft's BITMAPFILEHEADER and BITMAPINFOHEADER.
struct Header {
  std::int64_t pixels_at = 0;
  std::int64_t info_bytes = 0;
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  int bits = 0;
  std::uint32_t compression = 0;
  std::int64_t palette_entries = 0;
};

Header parse(std::span<const std::uint8_t> bytes) {
  Header header{.pixels_at = little_endian<std::uint32_t>(bytes, 10),
                .info_bytes = little_endian<std::uint32_t>(bytes, 14),
                .width_px = little_endian<std::int32_t>(bytes, 18),
                // negative: stored from the top row down
                .height_px = std::abs(std::int64_t{little_endian<std::int32_t>(bytes, 22)}),
                .bits = little_endian<std::uint16_t>(bytes, 28),
                .compression = little_endian<std::uint32_t>(bytes, 30),
                .palette_entries = little_endian<std::uint32_t>(bytes, 46)};
  if (header.bits == 8 && header.palette_entries == 0) header.palette_entries = 256;
  return header;
}

Result<void> check(const EncodedImage& in, const Header& header) {
  const auto size_bytes = static_cast<std::int64_t>(in.bytes.size());
  if (header.info_bytes < 40 || header.info_bytes > 124)
    return unsupported_image(in.name, "has a BMP header of a kind that lsv does not read");
  const auto size =
      check_image_size(in.name, header.width_px, header.height_px, in.options.max_pixels);
  if (!size) return size.error();
  if (header.compression != 0)
    return unsupported_image(in.name, "is a compressed BMP; save it uncompressed");
  if (header.bits != 8 && header.bits != 24 && header.bits != 32) {
    return unsupported_image(in.name, "has " + std::to_string(header.bits) +
                                          " bits per pixel; lsv reads BMP of 8, 24 and 32");
  }
  const std::int64_t palette_bytes = header.bits == 8 ? 4 * header.palette_entries : 0;
  if (header.palette_entries > 256 || 14 + header.info_bytes + palette_bytes > header.pixels_at)
    return bad_image(in.name, "BMP palette overlaps the pixels");
  const std::int64_t row_bytes = (header.width_px * header.bits + 31) / 32 * 4;
  if (header.pixels_at > size_bytes || row_bytes * header.height_px > size_bytes - header.pixels_at)
    return bad_image(in.name, "is too short for the size that its BMP header declares");
  return {};
}

void copy_grey(const cv::Mat& image, Frame& out) {
  for (int y = 0; y < image.rows; ++y)
    std::memcpy(out.row8(y), image.ptr(y), static_cast<std::size_t>(image.cols));
}

void copy_luma(const cv::Mat& image, Frame& out) {
  const int channels = image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const std::uint8_t* from = image.ptr(y);
    for (int x = 0; x < image.cols; ++x, from += channels)
      out.row8(y)[x] = static_cast<std::uint8_t>(luma(from[2], from[1], from[0]));
  }
}

}  // namespace

Result<ImageNotes> decode_bmp(const EncodedImage& in, Frame& out) {
  if (in.bytes.size() < kHeaders_bytes) return bad_image(in.name, "ends inside its BMP header");
  if (in.bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return bad_image(in.name, "is longer than the BMP decoder can take");
  const Header header = parse(in.bytes);
  const auto checked = check(in, header);
  if (!checked) return checked.error();

  cv::Mat image;
  try {
    const cv::Mat encoded(1, static_cast<int>(in.bytes.size()), CV_8UC1,
                          const_cast<std::uint8_t*>(in.bytes.data()));
    image = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  } catch (const std::exception& error) {
    return bad_image(in.name, std::string("damaged BMP: ") + error.what());
  }
  if (image.depth() != CV_8U || image.cols != header.width_px || image.rows != header.height_px)
    return bad_image(in.name, "damaged BMP: it could not be decoded");
  out.reset({.width_px = image.cols, .height_px = image.rows});
  if (image.channels() == 1) {
    copy_grey(image, out);
  } else {
    copy_luma(image, out);
  }
  return ImageNotes{.colour = image.channels() > 1, .alpha = header.bits == 32};
}

}  // namespace lsv
