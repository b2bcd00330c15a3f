// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/test_images.h"

#include <spng.h>
#include <tiffio.h>
#include <turbojpeg.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <stdexcept>

namespace lsv::test {
namespace {

void require(bool fine, const char* what) {
  if (!fine) throw std::runtime_error(std::string("test image: ") + what);
}

void append(Bytes& to, std::string_view text) { to.insert(to.end(), text.begin(), text.end()); }

void append_big_endian(Bytes& to, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    to.push_back(static_cast<std::uint8_t>(value >> shift));
}

void append_little_endian(Bytes& to, std::uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) to.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// Interleaved samples in words of this machine.
Bytes words_of(const TestImage& image) {
  Bytes out;
  for (const std::uint16_t sample : image.samples) {
    if (image.bits == 8) {
      out.push_back(static_cast<std::uint8_t>(sample));
    } else {
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(&sample);
      out.insert(out.end(), bytes, bytes + 2);
    }
  }
  return out;
}

std::uint32_t png_checksum(const Bytes& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

void append_chunk(Bytes& to, std::string_view type, const Bytes& data) {
  append_big_endian(to, static_cast<std::uint32_t>(data.size()));
  Bytes body = bytes_of(type);
  body.insert(body.end(), data.begin(), data.end());
  to.insert(to.end(), body.begin(), body.end());
  append_big_endian(to, png_checksum(body));
}

/// zlib stream of stored blocks.
Bytes deflate_stored(const Bytes& data) {
  require(data.size() < 65536, "one stored block holds less than 64 KiB");
  Bytes out = {0x78, 0x01, 0x01};
  const auto size = static_cast<std::uint32_t>(data.size());
  append_little_endian(out, size, 2);
  append_little_endian(out, ~size & 0xFFFFU, 2);
  out.insert(out.end(), data.begin(), data.end());
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const std::uint8_t byte : data) {
    a = (a + byte) % 65521U;
    b = (b + a) % 65521U;
  }
  append_big_endian(out, b << 16 | a);
  return out;
}

}  // namespace

TestImage random_image(int width_px, int height_px, std::uint32_t seed, int max_value,
                       int channels) {
  TestImage image{.width_px = width_px,
                  .height_px = height_px,
                  .channels = channels,
                  .bits = max_value > 255 ? 16 : 8,
                  .samples = {}};
  std::mt19937 random(seed);
  const auto count = static_cast<std::size_t>(width_px * height_px * channels);
  for (std::size_t i = 0; i < count; ++i) {
    image.samples.push_back(
        static_cast<std::uint16_t>(random() % (static_cast<unsigned>(max_value) + 1U)));
  }
  return image;
}

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

Bytes read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_bytes(const std::filesystem::path& path, const Bytes& bytes) {
  std::filesystem::remove(path);  // cutting an existing file makes some file systems flush it
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  require(file.good(), "cannot be written");
}

Bytes encode_pgm(const TestImage& image, int max_value, bool as_text) {
  Bytes out = bytes_of(std::string(as_text ? "P2" : "P5") + "\n# made for a test\n" +
                       std::to_string(image.width_px) + " " + std::to_string(image.height_px) +
                       "\n" + std::to_string(max_value) + "\n");
  for (const std::uint16_t sample : image.samples) {
    if (as_text) {
      append(out, std::to_string(sample) + "\n");
    } else {
      if (max_value > 255) out.push_back(static_cast<std::uint8_t>(sample >> 8));
      out.push_back(static_cast<std::uint8_t>(sample));
    }
  }
  return out;
}

Bytes encode_png(const TestImage& image, const PngExtras& extras) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(SPNG_CTX_ENCODER),
                                                               spng_ctx_free);
  constexpr std::array<std::uint8_t, 5> kTypes = {
      0, SPNG_COLOR_TYPE_GRAYSCALE, SPNG_COLOR_TYPE_GRAYSCALE_ALPHA, SPNG_COLOR_TYPE_TRUECOLOR,
      SPNG_COLOR_TYPE_TRUECOLOR_ALPHA};
  spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_ihdr header{.width = static_cast<std::uint32_t>(image.width_px),
                   .height = static_cast<std::uint32_t>(image.height_px),
                   .bit_depth = static_cast<std::uint8_t>(image.bits),
                   .color_type = kTypes[static_cast<std::size_t>(image.channels)],
                   .compression_method = 0,
                   .filter_method = 0,
                   .interlace_method = 0};
  require(spng_set_ihdr(context.get(), &header) == 0, "PNG header");
  if (extras.significant_bits > 0) {
    spng_sbit bits{};
    bits.grayscale_bits = static_cast<std::uint8_t>(extras.significant_bits);
    require(spng_set_sbit(context.get(), &bits) == 0, "PNG sBIT");
  }
  std::string hidden(extras.hidden_text_bytes, 'A');
  if (!hidden.empty()) {
    spng_text text{};
    text.keyword[0] = 'k';
    text.type = SPNG_ZTXT;
    text.length = hidden.size();
    text.text = hidden.data();
    require(spng_set_text(context.get(), &text, 1) == 0, "PNG text");
  }
  const Bytes words = words_of(image);
  require(spng_encode_image(context.get(), words.data(), words.size(), SPNG_FMT_PNG,
                            SPNG_ENCODE_FINALIZE) == 0,
          "PNG pixels");
  std::size_t size = 0;
  int error = 0;
  auto* encoded = static_cast<std::uint8_t*>(spng_get_png_buffer(context.get(), &size, &error));
  require(error == 0, "PNG buffer");
  Bytes out(encoded, encoded + size);
  std::free(encoded);
  return out;
}

Bytes png_with_header(std::uint32_t width, std::uint32_t height, int bits, int colour_type,
                      int interlace, const Bytes& data) {
  Bytes out = bytes_of("\x89PNG\r\n\x1a\n");
  Bytes header;
  append_big_endian(header, width);
  append_big_endian(header, height);
  header.push_back(static_cast<std::uint8_t>(bits));
  header.push_back(static_cast<std::uint8_t>(colour_type));
  header.push_back(0);
  header.push_back(0);
  header.push_back(static_cast<std::uint8_t>(interlace));
  append_chunk(out, "IHDR", header);
  if (colour_type == SPNG_COLOR_TYPE_INDEXED) {
    Bytes palette;
    for (int i = 0; i < 256; ++i) {
      for (const int value : {i, 255 - i, i / 2})
        palette.push_back(static_cast<std::uint8_t>(value));
    }
    append_chunk(out, "PLTE", palette);
  }
  append_chunk(out, "IDAT", deflate_stored(data));
  append_chunk(out, "IEND", {});
  return out;
}

Bytes encode_interlaced_png(const TestImage& image) {
  struct Pass {
    int x, y, step_x, step_y;
  };
  constexpr std::array<Pass, 7> kAdam7 = {{{0, 0, 8, 8},
                                           {4, 0, 8, 8},
                                           {0, 4, 4, 8},
                                           {2, 0, 4, 4},
                                           {0, 2, 2, 4},
                                           {1, 0, 2, 2},
                                           {0, 1, 1, 2}}};
  Bytes data;
  for (const Pass& pass : kAdam7) {
    if (pass.x >= image.width_px) continue;
    for (int y = pass.y; y < image.height_px; y += pass.step_y) {
      data.push_back(0);  // filter: none
      for (int x = pass.x; x < image.width_px; x += pass.step_x)
        data.push_back(static_cast<std::uint8_t>(image.at(x, y)));
    }
  }
  return png_with_header(static_cast<std::uint32_t>(image.width_px),
                         static_cast<std::uint32_t>(image.height_px), 8, SPNG_COLOR_TYPE_GRAYSCALE,
                         1, data);
}

Bytes encode_palette_png(const TestImage& image) {
  Bytes data;
  for (int y = 0; y < image.height_px; ++y) {
    data.push_back(0);
    for (int x = 0; x < image.width_px; ++x)
      data.push_back(static_cast<std::uint8_t>(image.at(x, y)));
  }
  return png_with_header(static_cast<std::uint32_t>(image.width_px),
                         static_cast<std::uint32_t>(image.height_px), 8, SPNG_COLOR_TYPE_INDEXED, 0,
                         data);
}

Bytes encode_jpeg(const TestImage& image, bool progressive) {
  const Bytes pixels = words_of(image);
  const bool grey = image.channels == 1;
  const tjhandle handle = tjInitCompress();
  unsigned char* encoded = nullptr;
  unsigned long size = 0;
  const int status = tjCompress2(
      handle, pixels.data(), image.width_px, 0, image.height_px, grey ? TJPF_GRAY : TJPF_RGB,
      &encoded, &size, grey ? TJSAMP_GRAY : TJSAMP_420, 90, progressive ? TJFLAG_PROGRESSIVE : 0);
  require(status == 0, "JPEG");
  Bytes out(encoded, encoded + size);
  tjFree(encoded);
  tjDestroy(handle);
  return out;
}

Bytes encode_bmp(const TestImage& image, bool top_down) {
  const int bits = image.channels == 1 ? 8 : image.channels * 8;
  const std::uint32_t palette_bytes = bits == 8 ? 1024 : 0;
  const int row_bytes = (image.width_px * bits + 31) / 32 * 4;
  const std::uint32_t pixels_at = 54 + palette_bytes;
  const auto pixel_bytes = static_cast<std::uint32_t>(row_bytes * image.height_px);
  Bytes out = bytes_of("BM");
  for (const std::uint32_t value : {pixels_at + pixel_bytes, 0U, pixels_at, 40U}) {
    append_little_endian(out, value, 4);
  }
  append_little_endian(out, static_cast<std::uint32_t>(image.width_px), 4);
  append_little_endian(
      out, static_cast<std::uint32_t>(top_down ? -image.height_px : image.height_px), 4);
  append_little_endian(out, 1, 2);
  append_little_endian(out, static_cast<std::uint32_t>(bits), 2);
  for (const std::uint32_t value : {0U, pixel_bytes, 2835U, 2835U, palette_bytes / 4, 0U})
    append_little_endian(out, value, 4);
  for (std::uint32_t i = 0; i < palette_bytes / 4; ++i) append_little_endian(out, i * 0x010101U, 4);
  for (int row = 0; row < image.height_px; ++row) {
    const int y = top_down ? row : image.height_px - 1 - row;
    const std::size_t row_end = out.size() + static_cast<std::size_t>(row_bytes);
    for (int x = 0; x < image.width_px; ++x) {
      for (int channel = std::min(image.channels, 3) - 1; channel >= 0; --channel)
        out.push_back(static_cast<std::uint8_t>(image.at(x, y, channel)));
      if (image.channels == 4) out.push_back(static_cast<std::uint8_t>(image.at(x, y, 3)));
    }
    out.resize(row_end);
  }
  return out;
}

namespace {

void write_tiff_pixels(TIFF* tiff, const TestImage& image, const TiffLayout& layout) {
  const Bytes words = words_of(image);
  const std::size_t pixel_bytes = static_cast<std::size_t>(image.channels * image.bits / 8);
  const std::size_t row_bytes = static_cast<std::size_t>(image.width_px) * pixel_bytes;
  if (layout.tile_px == 0) {
    for (int y = 0; y < image.height_px; ++y) {
      Bytes row(words.begin() + y * static_cast<std::ptrdiff_t>(row_bytes),
                words.begin() + (y + 1) * static_cast<std::ptrdiff_t>(row_bytes));
      require(TIFFWriteScanline(tiff, row.data(), static_cast<std::uint32_t>(y), 0) == 1,
              "TIFF row");
    }
    return;
  }
  const int side = layout.tile_px;
  for (int tile_y = 0; tile_y < image.height_px; tile_y += side) {
    for (int tile_x = 0; tile_x < image.width_px; tile_x += side) {
      Bytes tile(static_cast<std::size_t>(side * side) * pixel_bytes);
      for (int y = tile_y; y < std::min(tile_y + side, image.height_px); ++y) {
        for (int x = tile_x; x < std::min(tile_x + side, image.width_px); ++x) {
          const auto from = static_cast<std::size_t>(y * image.width_px + x) * pixel_bytes;
          const auto to = static_cast<std::size_t>((y - tile_y) * side + x - tile_x) * pixel_bytes;
          for (std::size_t i = 0; i < pixel_bytes; ++i) tile[to + i] = words[from + i];
        }
      }
      require(TIFFWriteTile(tiff, tile.data(), static_cast<std::uint32_t>(tile_x),
                            static_cast<std::uint32_t>(tile_y), 0, 0) > 0,
              "TIFF tile");
    }
  }
}

}  // namespace

void write_tiff(const std::filesystem::path& path, const std::vector<TestImage>& pages,
                const TiffLayout& layout) {
  TIFF* tiff = TIFFOpen(path.c_str(), layout.mode.c_str());
  require(tiff != nullptr, "TIFF file");
  for (const TestImage& image : pages) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, image.width_px);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, image.height_px);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, image.bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, image.channels);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, image.channels >= 3 ? 2 : layout.photometric);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, layout.sample_format);
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, layout.orientation);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, layout.compression);
    if (layout.predictor > 0) TIFFSetField(tiff, TIFFTAG_PREDICTOR, layout.predictor);
    if (layout.max_sample_value > 0)
      TIFFSetField(tiff, TIFFTAG_MAXSAMPLEVALUE, layout.max_sample_value);
    if (layout.tile_px > 0) {
      TIFFSetField(tiff, TIFFTAG_TILEWIDTH, layout.tile_px);
      TIFFSetField(tiff, TIFFTAG_TILELENGTH, layout.tile_px);
    } else {
      TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, layout.rows_per_strip);
    }
    write_tiff_pixels(tiff, image, layout);
    require(TIFFWriteDirectory(tiff) == 1, "TIFF page");
  }
  TIFFClose(tiff);
}

namespace {
constexpr int kTags = 8;
constexpr std::uint32_t kPageBytes = 2 + kTags * 12 + 4;
constexpr std::uint32_t kFirstPage = 8;
}  // namespace

std::uint32_t page_offset(int page) {
  return kFirstPage + kPageBytes * static_cast<std::uint32_t>(page);
}

Bytes encode(const HandmadeTiff& tiff) {
  Bytes out = {'I', 'I', 42, 0};
  append_little_endian(out, kFirstPage, 4);
  const std::uint32_t pixels_at = page_offset(tiff.pages);
  for (int page = 0; page < tiff.pages; ++page) {
    append_little_endian(out, kTags, 2);
    const std::array<std::array<std::uint32_t, 3>, kTags> tags = {
        {{TIFFTAG_IMAGEWIDTH, TIFF_LONG, tiff.width},
         {TIFFTAG_IMAGELENGTH, TIFF_LONG, tiff.height},
         {TIFFTAG_BITSPERSAMPLE, TIFF_SHORT, 8},
         {TIFFTAG_COMPRESSION, TIFF_SHORT, COMPRESSION_NONE},
         {TIFFTAG_PHOTOMETRIC, TIFF_SHORT, PHOTOMETRIC_MINISBLACK},
         {TIFFTAG_STRIPOFFSETS, TIFF_LONG, pixels_at},
         {TIFFTAG_ROWSPERSTRIP, TIFF_LONG, tiff.height},
         {TIFFTAG_STRIPBYTECOUNTS, TIFF_LONG, tiff.strip_bytes}}};
    for (const auto& [tag, type, value] : tags) {
      append_little_endian(out, tag, 2);
      append_little_endian(out, type, 2);
      append_little_endian(out, 1, 4);
      append_little_endian(out, value, 4);
    }
    const bool last = page + 1 == tiff.pages;
    append_little_endian(out, last ? tiff.last_next.value_or(0) : page_offset(page + 1), 4);
  }
  for (std::uint32_t i = 0; i < tiff.stored_bytes; ++i)
    out.push_back(static_cast<std::uint8_t>(3 * i));
  return out;
}

bool same_pixels(const FrameView& frame, const TestImage& image) {
  if (frame.width_px() != image.width_px || frame.height_px() != image.height_px) return false;
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      if (frame.at(x, y) != image.at(x, y)) return false;
    }
  }
  return true;
}

std::filesystem::path fresh_folder(const std::filesystem::path& base, const std::string& name) {
  auto folder = base / (name + "." + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace lsv::test
