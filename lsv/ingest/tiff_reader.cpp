// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/tiff_reader.h"

#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <utility>

#include "lsv/ingest/decoders.h"

namespace lsv {

namespace {

int keep_complaint(TIFF*, void* user, const char*, const char* format, va_list args) {
  char text[200];
  std::vsnprintf(text, sizeof text, format, args);
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  *static_cast<std::string*>(user) = text;
  return 1;  // handled: nothing is printed
}

int ignore_warning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

struct FreeOptions {
  void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
};

template <typename Number>
Number tag(TIFF* tiff, std::uint32_t which, Number otherwise) {
  Number value{};
  return TIFFGetFieldDefaulted(tiff, which, &value) == 1 ? value : otherwise;
}

bool readable_compression(std::uint16_t scheme) {
  switch (scheme) {
    case COMPRESSION_NONE:
    case COMPRESSION_LZW:
    case COMPRESSION_ADOBE_DEFLATE:
    case COMPRESSION_DEFLATE:
    case COMPRESSION_PACKBITS:
    case COMPRESSION_ZSTD:
      return TIFFIsCODECConfigured(scheme) == 1;
    default:
      return false;
  }
}

const char* refusal_of_layout(TIFF* tiff) {
  if (tag<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1) != 1)
    return "is a colour or multi-channel TIFF; lsv reads grey ones";
  switch (tag<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK)) {
    case PHOTOMETRIC_MINISBLACK:
      break;
    case PHOTOMETRIC_MINISWHITE:
      return "stores dark as white (MinIsWhite); invert it to MinIsBlack first";
    default:
      return "is a colour or palette TIFF; lsv reads grey ones";
  }
  if (tag<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT) != SAMPLEFORMAT_UINT)
    return "has signed or floating-point pixels; lsv reads unsigned ones";
  if (tag<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) != ORIENTATION_TOPLEFT)
    return "is stored rotated or flipped (Orientation); save it with the top row first";
  if (!readable_compression(tag<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE)))
    return "has a compression that lsv does not read; use none, LZW, deflate or PackBits";
  return nullptr;
}

Result<FrameFormat> page_format(TIFF* tiff, const std::string& name, const DecodeOptions& options) {
  const auto width = tag<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
  const auto height = tag<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
  const auto size = check_image_size(name, width, height, options.max_pixels);
  if (!size) return size.error();
  if (const char* refusal = refusal_of_layout(tiff)) return unsupported_image(name, refusal);
  FrameFormat format{.width_px = static_cast<int>(width), .height_px = static_cast<int>(height)};
  switch (const auto bits = tag<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1)) {
    case 8:
      return format;
    case 16:
      format.type = PixelType::mono16;
      format.bit_depth = options.bit_depth.value_or(
          std::max(10, bit_depth_for(tag<std::uint16_t>(tiff, TIFFTAG_MAXSAMPLEVALUE, 65535))));
      return format;
    default:
      return unsupported_image(
          name, "has " + std::to_string(bits) + "-bit pixels; lsv reads 8 and 16 bit TIFF");
  }
}

std::size_t row_bytes(const FrameFormat& format) {
  return static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
}

bool read_strips(TIFF* tiff, Frame& out) {
  const FrameFormat format = out.view().format;
  if (TIFFScanlineSize64(tiff) != row_bytes(format)) return false;
  for (int y = 0; y < format.height_px; ++y) {
    if (TIFFReadScanline(tiff, out.row(y), static_cast<std::uint32_t>(y), 0) != 1) return false;
  }
  return true;
}

void copy_tile(const std::vector<std::uint8_t>& tile, std::size_t tile_row_bytes, const Roi& part,
               Frame& out) {
  const std::size_t pixel_bytes = bytes_per_pixel(out.view().format.type);
  for (int y = 0; y < part.height_px; ++y) {
    std::memcpy(out.row(part.y_px + y) + static_cast<std::size_t>(part.x_px) * pixel_bytes,
                tile.data() + static_cast<std::size_t>(y) * tile_row_bytes,
                static_cast<std::size_t>(part.width_px) * pixel_bytes);
  }
}

bool read_tiles(TIFF* tiff, std::vector<std::uint8_t>& tile, Frame& out) {
  const FrameFormat format = out.view().format;
  const auto tile_width = tag<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH, 0);
  const auto tile_height = tag<std::uint32_t>(tiff, TIFFTAG_TILELENGTH, 0);
  // A tile much larger than its page is a lie that would cost memory.
  const auto fits = [](std::uint32_t tile_px, int page_px) {
    return tile_px > 0 && tile_px <= std::max(1024U, static_cast<std::uint32_t>(page_px) + 15U);
  };
  if (!fits(tile_width, format.width_px) || !fits(tile_height, format.height_px)) return false;
  const std::size_t tile_row_bytes = tile_width * bytes_per_pixel(format.type);
  if (TIFFTileSize64(tiff) != tile_row_bytes * tile_height) return false;
  tile.resize(tile_row_bytes * tile_height);
  const auto size = static_cast<tmsize_t>(tile.size());
  const int step_x = static_cast<int>(tile_width);
  const int step_y = static_cast<int>(tile_height);
  for (int y = 0; y < format.height_px; y += step_y) {
    for (int x = 0; x < format.width_px; x += step_x) {
      const auto number =
          TIFFComputeTile(tiff, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0, 0);
      if (TIFFReadEncodedTile(tiff, number, tile.data(), size) != size) return false;
      copy_tile(tile, tile_row_bytes,
                {.x_px = x,
                 .y_px = y,
                 .width_px = std::min(step_x, format.width_px - x),
                 .height_px = std::min(step_y, format.height_px - y)},
                out);
    }
  }
  return true;
}

}  // namespace

TiffReader::TiffReader(const std::string& path, const DecodeOptions& options, FileHandle file)
    : path_(path), options_(options), file_(std::move(file)) {
  const std::unique_ptr<TIFFOpenOptions, FreeOptions> settings(TIFFOpenOptionsAlloc());
  if (!settings) return;
  // Whatever a file claims, libtiff takes no block larger than the largest page needs.
  constexpr std::int64_t kMetadata_bytes = std::int64_t{16} << 20;
  const std::int64_t block_bytes =
      std::min(options_.max_pixels, std::int64_t{1} << 40) * 2 + kMetadata_bytes;
  TIFFOpenOptionsSetMaxSingleMemAlloc(settings.get(), static_cast<tmsize_t>(block_bytes));
  TIFFOpenOptionsSetErrorHandlerExtR(settings.get(), keep_complaint, &complaint_);
  TIFFOpenOptionsSetWarningHandlerExtR(settings.get(), ignore_warning, nullptr);
  // m: no memory map, since a file that shrinks under a map ends the process.
  tiff_ = TIFFFdOpenExt(file_.fd(), path_.c_str(), "rm", settings.get());
}

TiffReader::~TiffReader() {
  if (tiff_ != nullptr) TIFFCleanup(tiff_);  // file_ closes the file
}

Result<std::unique_ptr<TiffReader>> TiffReader::open(const std::string& path,
                                                     const DecodeOptions& options) {
  auto file = open_regular_file(path);
  if (!file) return file.error();
  if (file.value().size_bytes == 0) return bad_image(path, "is empty");
  std::unique_ptr<TiffReader> reader(new TiffReader(path, options, std::move(file.value().handle)));
  if (reader->tiff_ == nullptr) {
    return bad_image(path, "is not a readable TIFF file: " + reader->complaint_);
  }
  return reader;
}

std::string TiffReader::page_name() const { return path_ + ", page " + std::to_string(page_); }

Error TiffReader::damaged() const {
  return bad_image(page_name(),
                   "damaged TIFF: " + (complaint_.empty() ? "it is incomplete" : complaint_));
}

Result<std::int64_t> TiffReader::count_pages() {
  complaint_.clear();
  const tdir_t count = TIFFNumberOfDirectories(tiff_);
  // libtiff stops counting at a loop without a word: the last page counted must end the chain.
  const bool complete = complaint_.empty() && count > 0 &&
                        TIFFSetDirectory(tiff_, count - 1) == 1 && on_last_page() &&
                        TIFFSetDirectory(tiff_, 0) == 1;
  if (!complete) {
    return bad_image(path_, "damaged TIFF: the chain of pages is broken after " +
                                std::to_string(count) + " pages" +
                                (complaint_.empty() ? "" : ": " + complaint_));
  }
  return static_cast<std::int64_t>(count);
}

bool TiffReader::on_last_page() const { return TIFFLastDirectory(tiff_) != 0; }

Result<void> TiffReader::go_to_next_page() {
  complaint_.clear();
  ++page_;
  if (TIFFReadDirectory(tiff_) != 1) return damaged();
  return {};
}

Result<void> TiffReader::read_page(Frame& out) {
  complaint_.clear();
  const auto format = page_format(tiff_, page_name(), options_);
  if (!format) return format.error();
  out.reset(format.value());
  const bool whole =
      TIFFIsTiled(tiff_) != 0 ? read_tiles(tiff_, tile_, out) : read_strips(tiff_, out);
  if (!whole) return damaged();
  return {};
}

}  // namespace lsv
