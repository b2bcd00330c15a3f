// SPDX-License-Identifier: BSD-3-Clause
// Small images with known pixels and their encoders, for tests and fuzz seeds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lsv/core/frame.h"

namespace lsv::test {

using Bytes = std::vector<std::uint8_t>;

struct TestImage {
  int width_px = 0;
  int height_px = 0;
  int channels = 1;  // 1 grey, 2 grey + alpha, 3 RGB, 4 RGBA
  int bits = 8;      // of a stored word: 8 or 16
  std::vector<std::uint16_t> samples;

  std::uint16_t at(int x_px, int y_px, int channel = 0) const {
    return samples[static_cast<std::size_t>((y_px * width_px + x_px) * channels + channel)];
  }
};

/// Random samples in [0, max_value], the same for the same seed.
TestImage random_image(int width_px, int height_px, std::uint32_t seed, int max_value = 255,
                       int channels = 1);

Bytes bytes_of(std::string_view text);
Bytes read_bytes(const std::filesystem::path& path);
void write_bytes(const std::filesystem::path& path, const Bytes& bytes);

Bytes encode_pgm(const TestImage& image, int max_value, bool as_text = false);

struct PngExtras {
  int significant_bits = 0;           // writes sBIT
  std::size_t hidden_text_bytes = 0;  // writes a zTXt chunk that unpacks to so much
};
Bytes encode_png(const TestImage& image, const PngExtras& extras = {});
/// 8-bit grey, Adam7.
Bytes encode_interlaced_png(const TestImage& image);
/// 8-bit palette, entry i = (i, 255 - i, i / 2).
Bytes encode_palette_png(const TestImage& image);
/// Signature, header with a true checksum, and `data` as the only IDAT.
Bytes png_with_header(std::uint32_t width, std::uint32_t height, int bits, int colour_type,
                      int interlace, const Bytes& data);

Bytes encode_jpeg(const TestImage& image, bool progressive = false);

/// 8 bits with a grey palette for 1 channel, else 24 or 32 bits.
Bytes encode_bmp(const TestImage& image, bool top_down = false);

struct TiffLayout {
  int compression = 1;  // COMPRESSION_NONE
  int photometric = 1;  // PHOTOMETRIC_MINISBLACK
  int sample_format = 1;
  int orientation = 1;
  int predictor = 0;         // 0: none written
  int tile_px = 0;           // 0: strips
  int rows_per_strip = 5;    // odd on purpose
  int max_sample_value = 0;  // 0: none written
  std::string mode = "w";    // "wb" big-endian, "w8" BigTIFF
};
void write_tiff(const std::filesystem::path& path, const std::vector<TestImage>& pages,
                const TiffLayout& layout = {});

/// An uncompressed 8-bit TIFF built by hand, so that it can lie.
struct HandmadeTiff {
  std::uint32_t width = 8;
  std::uint32_t height = 8;
  int pages = 1;
  std::optional<std::uint32_t> last_next =
      {};                          // offset of the page after the last; unset: 0, the end
  std::uint32_t strip_bytes = 64;  // claimed; libtiff corrects it when `stored_bytes` suffice
  std::uint32_t stored_bytes = 64;
};
Bytes encode(const HandmadeTiff& tiff);
/// The offset of page `page` in encode()'s result.
std::uint32_t page_offset(int page);

/// True when the pixels are those of channel 0 of `image`.
bool same_pixels(const FrameView& frame, const TestImage& image);

/// A fresh folder below testing::TempDir()-like `base`, unique to `name` and the process.
std::filesystem::path fresh_folder(const std::filesystem::path& base, const std::string& name);

}  // namespace lsv::test
