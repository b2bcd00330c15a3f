// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/image_decode.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <filesystem>
#include <limits>

#include "lsv/ingest/decoders.h"
#include "lsv/ingest/input_file.h"
#include "lsv/ingest/raw_source.h"
#include "lsv/ingest/tiff_reader.h"

namespace lsv {
namespace {

constexpr std::array kExtensions = {std::pair{std::string_view(".png"), ImageKind::png},
                                    std::pair{std::string_view(".tif"), ImageKind::tiff},
                                    std::pair{std::string_view(".tiff"), ImageKind::tiff},
                                    std::pair{std::string_view(".pgm"), ImageKind::pgm},
                                    std::pair{std::string_view(".bmp"), ImageKind::bmp},
                                    std::pair{std::string_view(".jpg"), ImageKind::jpeg},
                                    std::pair{std::string_view(".jpeg"), ImageKind::jpeg}};

// Room for 16-bit RGBA that does not compress at all, and for metadata.
std::int64_t max_encoded_bytes(std::int64_t max_pixels) {
  constexpr std::int64_t kMetadata_bytes = std::int64_t{16} << 20;
  const std::int64_t limit = (std::numeric_limits<std::int64_t>::max() - kMetadata_bytes) / 8;
  return std::min(max_pixels, limit) * 8 + kMetadata_bytes;
}

bool starts_with(std::span<const std::uint8_t> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

bool magic_agrees(std::span<const std::uint8_t> bytes, ImageKind kind) {
  switch (kind) {
    case ImageKind::png:
      return starts_with(bytes, "\x89PNG\r\n\x1a\n");
    case ImageKind::pgm:
      return starts_with(bytes, "P5") || starts_with(bytes, "P2");
    case ImageKind::bmp:
      return starts_with(bytes, "BM");
    case ImageKind::jpeg:
      return starts_with(bytes, "\xff\xd8\xff");
    case ImageKind::raw:
      return true;
    case ImageKind::tiff:
      break;  // tiff_reader checks for itself
  }
  return false;
}

Result<ImageNotes> read_single_page(const std::string& path, const DecodeOptions& options,
                                    Frame& out) {
  auto tiff = TiffReader::open(path, options);
  if (!tiff) return tiff.error();
  TiffReader& reader = *tiff.value();
  if (!reader.on_last_page()) {
    return Error{ErrorCode::bad_input,
                 path + ": has more than one page; give a multi-page TIFF alone, not in a list"};
  }
  const auto read = reader.read_page(out);
  if (!read) return read.error();
  return ImageNotes{};
}

/// A file of one raw frame.
Result<ImageNotes> decode_raw(const EncodedImage& in, Frame& out) {
  if (const auto checked = check_raw_size(in.name, *in.options.raw, in.options.max_pixels);
      !checked)
    return checked.error();
  const std::int64_t frame_bytes = bytes_per_frame(in.options.raw->format);
  const std::int64_t expected_bytes = in.options.raw->header_bytes + frame_bytes;
  const auto size_bytes = static_cast<std::int64_t>(in.bytes.size());
  if (size_bytes != expected_bytes) {
    return bad_image(in.name, "holds " + std::to_string(size_bytes) + " bytes but one frame of " +
                                  "--raw needs " + std::to_string(expected_bytes) +
                                  "; a file of several frames must be given alone");
  }
  copy_raw_frame(in.bytes.last(static_cast<std::size_t>(frame_bytes)), in.options.raw->format, out);
  return ImageNotes{};
}

}  // namespace

std::string_view word(ImageKind kind) {
  switch (kind) {
    case ImageKind::png:
      return "PNG";
    case ImageKind::tiff:
      return "TIFF";
    case ImageKind::pgm:
      return "PGM";
    case ImageKind::bmp:
      return "BMP";
    case ImageKind::jpeg:
      return "JPEG";
    case ImageKind::raw:
      return "raw";
  }
  return "unknown";
}

std::optional<ImageKind> image_kind_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const auto& [candidate, kind] : kExtensions) {
    if (extension == candidate) return kind;
  }
  return std::nullopt;
}

Error bad_image(const std::string& name, const std::string& what) {
  return {ErrorCode::bad_input, name + ": " + what};
}

Error unsupported_image(const std::string& name, const std::string& what) {
  return {ErrorCode::unsupported, name + ": " + what};
}

Result<void> check_image_size(const std::string& name, std::int64_t width_px,
                              std::int64_t height_px, std::int64_t max_pixels) {
  const std::string size = std::to_string(width_px) + " x " + std::to_string(height_px) + " px";
  if (width_px <= 0 || height_px <= 0)
    return bad_image(name, "declares " + size + ", which holds no pixel");
  constexpr std::int64_t kMaxSide_px = std::numeric_limits<int>::max() / 8;
  if (width_px > kMaxSide_px || height_px > kMaxSide_px || height_px > max_pixels / width_px) {
    return bad_image(
        name, "declares " + size + ", above the limit of " + std::to_string(max_pixels) + " px");
  }
  return {};
}

int bit_depth_for(int max_value) {
  if (max_value <= 255) return 8;
  const int bits = static_cast<int>(std::bit_width(static_cast<unsigned>(max_value)));
  return std::min(16, std::max(10, (bits + 1) / 2 * 2));
}

Result<ImageNotes> ImageReader::read(const std::string& path, ImageKind kind, Frame& out) {
  if (kind == ImageKind::tiff) return read_single_page(path, options_, out);
  const auto loaded = read_regular_file(path, max_encoded_bytes(options_.max_pixels), encoded_);
  if (!loaded) return loaded.error();
  if (encoded_.empty()) return bad_image(path, "is empty");
  if (!magic_agrees(encoded_, kind)) {
    return bad_image(path, "does not begin like a " + std::string(word(kind)) +
                               " file; its name and its content disagree");
  }
  const EncodedImage in{path, encoded_, options_};
  switch (kind) {
    case ImageKind::png:
      return decode_png(in, scratch_, out);
    case ImageKind::jpeg:
      return decode_jpeg(in, out);
    case ImageKind::bmp:
      return decode_bmp(in, out);
    case ImageKind::raw:
      return decode_raw(in, out);
    default:
      return decode_pgm(in, out);
  }
}

}  // namespace lsv
