// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/frame_writer.h"

#include <fcntl.h>
#include <spng.h>
#include <tiffio.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <system_error>
#include <utility>
#include <vector>

#include "lsv/output/output_file.h"

namespace lsv {
namespace {

Error failed(const std::string& path, const std::string& why) {
  return {ErrorCode::output_failed, "cannot write " + path + ": " + why};
}

std::size_t row_bytes(const FrameFormat& format) {
  return static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
}

/// Rows without gaps between them, words in the machine's byte order.
std::vector<std::byte> packed(const FrameView& frame) {
  std::vector<std::byte> pixels;
  pixels.reserve(row_bytes(frame.format) * static_cast<std::size_t>(frame.height_px()));
  for (int y = 0; y < frame.height_px(); ++y) {
    const std::byte* row = frame.data + y * frame.stride_bytes;
    pixels.insert(pixels.end(), row, row + row_bytes(frame.format));
  }
  return pixels;
}

std::vector<std::byte> packed_in_order(const FrameView& frame, std::endian order) {
  std::vector<std::byte> pixels = packed(frame);
  if (frame.format.type == PixelType::mono16 && order != std::endian::native) {
    for (std::size_t n = 0; n < pixels.size(); n += 2) std::swap(pixels[n], pixels[n + 1]);
  }
  return pixels;
}

std::vector<std::byte> packed_to_high_bits(const FrameView& frame) {
  std::vector<std::byte> pixels = packed(frame);
  if (frame.format.type == PixelType::mono8) return pixels;
  auto* words = reinterpret_cast<std::uint16_t*>(pixels.data());
  const int shift = 16 - frame.format.bit_depth;
  for (std::size_t n = 0; n < pixels.size() / 2; ++n)
    words[n] = static_cast<std::uint16_t>(words[n] << shift);
  return pixels;
}

Result<void> write_file(const std::string& path, std::string_view head, const void* body,
                        std::size_t body_bytes) {
  Result<OutputFile> file = OutputFile::open(path);
  if (!file) return file.error();
  if (auto done = file.value().write(head); !done) return done;
  if (auto done = file.value().write({static_cast<const char*>(body), body_bytes}); !done)
    return done;
  return file.value().commit();
}

Error png_error(int code) { return {ErrorCode::output_failed, spng_strerror(code)}; }

Result<std::string> encode(const FrameView& frame) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(SPNG_CTX_ENCODER),
                                                               spng_ctx_free);
  if (!context) return png_error(SPNG_EMEM);
  const bool wide = frame.format.type == PixelType::mono16;
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(frame.width_px());
  header.height = static_cast<std::uint32_t>(frame.height_px());
  header.bit_depth = wide ? 16 : 8;
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  int code = spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  if (code == 0) code = spng_set_ihdr(context.get(), &header);
  if (code == 0 && wide && frame.format.bit_depth < 16) {
    spng_sbit significant{};
    significant.grayscale_bits = static_cast<std::uint8_t>(frame.format.bit_depth);
    code = spng_set_sbit(context.get(), &significant);
  }
  const std::vector<std::byte> pixels = packed_to_high_bits(frame);
  if (code == 0) {
    code = spng_encode_image(context.get(), pixels.data(), pixels.size(), SPNG_FMT_PNG,
                             SPNG_ENCODE_FINALIZE);
  }
  if (code != 0) return png_error(code);
  std::size_t png_bytes = 0;
  const std::unique_ptr<void, void (*)(void*)> png(
      spng_get_png_buffer(context.get(), &png_bytes, &code), std::free);
  if (!png) return png_error(code);
  return std::string(static_cast<const char*>(png.get()), png_bytes);
}

Result<void> write_png(const FrameView& frame, const std::string& path) {
  const Result<std::string> png = encode(frame);
  if (!png) return failed(path, png.error().message);
  return lsv::write_file(path, png.value());
}

Result<void> write_pgm(const FrameView& frame, const std::string& path) {
  const std::string head = "P5\n" + std::to_string(frame.width_px()) + " " +
                           std::to_string(frame.height_px()) + "\n" +
                           std::to_string(full_scale_counts(frame.format.bit_depth)) + "\n";
  const std::vector<std::byte> pixels = packed_in_order(frame, std::endian::big);
  return write_file(path, head, pixels.data(), pixels.size());
}

Result<void> write_raw(const FrameView& frame, const std::string& path) {
  const std::vector<std::byte> pixels = packed_in_order(frame, std::endian::little);
  return write_file(path, {}, pixels.data(), pixels.size());
}

Result<void> write_tiff(const FrameView& frame, const std::string& path) {
  Result<TiffStackWriter> stack = TiffStackWriter::create(path, 0);
  if (!stack) return stack.error();
  if (auto done = stack.value().append(frame); !done) return done;
  return stack.value().commit();
}

Result<void> write_unguarded(const FrameView& frame, FrameFileFormat format,
                             const std::string& path) {
  switch (format) {
    case FrameFileFormat::png:
      return write_png(frame, path);
    case FrameFileFormat::pgm:
      return write_pgm(frame, path);
    case FrameFileFormat::tiff:
      return write_tiff(frame, path);
    case FrameFileFormat::raw:
      return write_raw(frame, path);
  }
  return failed(path, "its format is unknown");
}

struct FormatWord {
  FrameFileFormat format;
  std::string_view word;
  std::string_view extension;
};
constexpr std::array kFormatWords = {FormatWord{FrameFileFormat::png, "png", ".png"},
                                     FormatWord{FrameFileFormat::pgm, "pgm", ".pgm"},
                                     FormatWord{FrameFileFormat::tiff, "tiff", ".tif"},
                                     FormatWord{FrameFileFormat::raw, "raw", ".raw"}};

constexpr std::int64_t kBigTiffFrom_bytes = 3'500'000'000;

/// libtiff's message goes to the string that create() gave it instead of to stderr.
int keep_message(TIFF*, void* message, const char*, const char* format, std::va_list arguments) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  *static_cast<std::string*>(message) = text.data();
  return 1;
}

int drop_warning(TIFF*, void*, const char*, const char*, std::va_list) { return 1; }

/// Descriptions of the page; libtiff checks them again when it writes the page.
bool set_page(TIFF* tiff, const FrameFormat& format) {
  return TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(format.width_px)) &&
         TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(format.height_px)) &&
         TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(format.height_px)) &&
         TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, format.type == PixelType::mono8 ? 8 : 16) &&
         TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1) &&
         TIFFSetField(tiff, TIFFTAG_MAXSAMPLEVALUE, full_scale_counts(format.bit_depth)) &&
         TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK) &&
         TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) &&
         TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE) &&
         TIFFSetField(tiff, TIFFTAG_PREDICTOR, PREDICTOR_HORIZONTAL);
}

}  // namespace

std::optional<FrameFileFormat> frame_file_format_from(std::string_view word) {
  for (const FormatWord& entry : kFormatWords) {
    if (entry.word == word) return entry.format;
  }
  return std::nullopt;
}

std::string_view extension(FrameFileFormat format) {
  for (const FormatWord& entry : kFormatWords) {
    if (entry.format == format) return entry.extension;
  }
  return "";
}

Result<std::string> encode_png(const FrameView& frame) {
  try {
    return encode(frame);
  } catch (const std::bad_alloc&) {
    return png_error(SPNG_EMEM);
  }
}

Result<void> write_frame(const FrameView& frame, FrameFileFormat format, const std::string& path) {
  try {
    return write_unguarded(frame, format, path);
  } catch (const std::bad_alloc&) {
    return failed(path, "memory is short");
  }
}

struct TiffStackWriter::Stack {
  std::string path;
  std::string part_path;
  std::string message;
  TIFF* tiff = nullptr;

  ~Stack() {
    if (!tiff) return;
    TIFFClose(tiff);
    ::unlink(part_path.c_str());
  }

  Error abandon() {
    const std::string why = message.empty() ? "libtiff gives no reason" : message;
    TIFFClose(std::exchange(tiff, nullptr));
    ::unlink(part_path.c_str());
    return failed(path, why + "; check the disk and run again");
  }
};

TiffStackWriter::TiffStackWriter(std::unique_ptr<Stack> stack) : stack_(std::move(stack)) {}
TiffStackWriter::TiffStackWriter(TiffStackWriter&&) noexcept = default;
TiffStackWriter::~TiffStackWriter() = default;

Result<TiffStackWriter> TiffStackWriter::create(const std::string& path,
                                                std::int64_t expected_bytes) {
  auto stack = std::make_unique<Stack>();
  stack->path = path;
  stack->part_path = path + ".part";
  const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                             TIFFOpenOptionsFree);
  if (!options) return failed(path, "memory is short");
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_message, &stack->message);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), drop_warning, nullptr);
  const char* mode = expected_bytes > kBigTiffFrom_bytes ? "w8" : "w";
  stack->tiff = TIFFOpenExt(stack->part_path.c_str(), mode, options.get());
  if (!stack->tiff) return failed(path, stack->message);
  return TiffStackWriter(std::move(stack));
}

Result<void> TiffStackWriter::append(const FrameView& frame) {
  if (!stack_->tiff) return failed(stack_->path, "it is closed already");
  try {
    std::vector<std::byte> pixels = packed(frame);
    const auto pixel_bytes = static_cast<tmsize_t>(pixels.size());
    if (!set_page(stack_->tiff, frame.format) ||
        TIFFWriteEncodedStrip(stack_->tiff, 0, pixels.data(), pixel_bytes) != pixel_bytes ||
        !TIFFWriteDirectory(stack_->tiff)) {
      return stack_->abandon();
    }
    return {};
  } catch (const std::bad_alloc&) {
    return failed(stack_->path, "memory is short");
  }
}

Result<void> TiffStackWriter::commit() {
  if (!stack_->tiff) return failed(stack_->path, "it is closed already");
  // TIFFClose reports nothing, so everything is written and synced before it.
  stack_->message.clear();
  if (!TIFFFlush(stack_->tiff)) return stack_->abandon();
  if (::fsync(TIFFFileno(stack_->tiff)) != 0 ||
      std::rename(stack_->part_path.c_str(), stack_->path.c_str()) != 0) {
    stack_->message = std::generic_category().message(errno);
    return stack_->abandon();
  }
  TIFFClose(std::exchange(stack_->tiff, nullptr));
  return {};
}

}  // namespace lsv
