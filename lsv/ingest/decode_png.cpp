// SPDX-License-Identifier: BSD-3-Clause
// PNG through libspng: samples as stored, no gamma, damaged checksums are errors.
#include <spng.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "lsv/ingest/decoders.h"

namespace lsv {
namespace {

struct FreeContext {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using Context = std::unique_ptr<spng_ctx, FreeContext>;

// Text and colour profiles are not used, so that little of them is ever unpacked.
constexpr std::size_t kMaxChunk_bytes = std::size_t{1} << 20;
constexpr std::size_t kMaxAllChunks_bytes = std::size_t{4} << 20;
// No deflate stream unpacks to more than this many times its size.
constexpr std::size_t kMaxDeflateRatio = 1032;

Error png_error(const EncodedImage& in, int code) {
  return bad_image(in.name, std::string("damaged PNG: ") + spng_strerror(code));
}

/// `bytes` outlive the context.
Result<Context> open_png(const EncodedImage& in) {
  Context context(spng_ctx_new(0));
  if (!context) return png_error(in, SPNG_EMEM);
  int code = spng_set_crc_action(context.get(), SPNG_CRC_ERROR, SPNG_CRC_ERROR);
  if (code == 0) code = spng_set_chunk_limits(context.get(), kMaxChunk_bytes, kMaxAllChunks_bytes);
  if (code == 0) code = spng_set_png_buffer(context.get(), in.bytes.data(), in.bytes.size());
  if (code != 0) return png_error(in, code);
  return context;
}

Result<spng_ihdr> read_header(const EncodedImage& in, spng_ctx* context) {
  spng_ihdr header{};
  if (const int code = spng_get_ihdr(context, &header); code != 0) return png_error(in, code);
  const auto size = check_image_size(in.name, header.width, header.height, in.options.max_pixels);
  if (!size) return size.error();
  if (header.bit_depth < 8 && header.color_type != SPNG_COLOR_TYPE_INDEXED) {
    return unsupported_image(in.name, "has " + std::to_string(header.bit_depth) +
                                          "-bit pixels; lsv reads 8 and 16 bit PNG");
  }
  return header;
}

bool present(int code) { return code == 0; }

/// sBIT of a 16-bit grey image, or 16.
int significant_bits(spng_ctx* context) {
  spng_sbit sbit{};
  if (!present(spng_get_sbit(context, &sbit))) return 16;
  return sbit.grayscale_bits;
}

/// The PNG standard keeps n significant bits in the HIGH bits of a sample (the low ones are zero
/// or repeat the high ones), so a shift to the right gives back the camera's counts.
Result<void> undo_scaling(const EncodedImage& in, int bits, Frame& out) {
  const FrameFormat format = out.view().format;
  const int drop = 16 - bits;
  for (int y = 0; y < format.height_px; ++y) {
    std::uint16_t* row = out.row16(y);
    for (int x = 0; x < format.width_px; ++x) {
      const int low = row[x] & ((1 << drop) - 1);
      if (low != 0 && low != row[x] >> bits) {
        return bad_image(in.name, "its sBIT chunk says " + std::to_string(bits) +
                                      " bits but its pixels are not scaled to 16 bit as PNG asks; "
                                      "give --bit-depth to say how many low bits carry signal");
      }
      row[x] = static_cast<std::uint16_t>(row[x] >> drop);
    }
  }
  return {};
}

Result<void> read_rows(const EncodedImage& in, spng_ctx* context, Frame& out) {
  const FrameFormat format = out.view().format;
  const std::size_t row_bytes =
      static_cast<std::size_t>(format.width_px) * bytes_per_pixel(format.type);
  int code = spng_decode_image(context, nullptr, 0, SPNG_FMT_PNG, SPNG_DECODE_PROGRESSIVE);
  while (code == 0) {
    spng_row_info info{};
    code = spng_get_row_info(context, &info);
    if (code != 0) break;
    if (info.row_num >= static_cast<std::uint32_t>(format.height_px))
      return png_error(in, SPNG_EINTERNAL);
    code = spng_decode_row(context, out.row(static_cast<int>(info.row_num)), row_bytes);
  }
  if (code != SPNG_EOI) return png_error(in, code);
  return {};
}

Result<void> decode_grey(const EncodedImage& in, spng_ctx* context, const spng_ihdr& header,
                         Frame& out) {
  FrameFormat format{.width_px = static_cast<int>(header.width),
                     .height_px = static_cast<int>(header.height)};
  if (header.bit_depth == 16) {
    format.type = PixelType::mono16;
    format.bit_depth = in.options.bit_depth.value_or(16);
  }
  out.reset(format);
  auto rows = read_rows(in, context, out);
  if (!rows || header.bit_depth != 16 || in.options.bit_depth) return rows;
  const int bits = significant_bits(context);
  if (bits >= 16) return rows;
  auto scaled = undo_scaling(in, bits, out);
  if (!scaled) return scaled;
  format.bit_depth = std::max(10, bit_depth_for((1 << bits) - 1));
  out.reset(format);  // the pixels stay: only the depth changes
  return {};
}

template <typename Word>
Word word_at(const std::uint8_t* from) {
  Word word;
  std::memcpy(&word, from, sizeof word);
  return word;
}

template <typename Word>
void to_luma(const std::uint8_t* from, int channels, const FrameFormat& format, Frame& out) {
  for (int y = 0; y < format.height_px; ++y) {
    Word* row = reinterpret_cast<Word*>(out.row(y));
    for (int x = 0; x < format.width_px; ++x) {
      const int first = word_at<Word>(from);
      const int grey = channels >= 3 ? luma(first, word_at<Word>(from + sizeof(Word)),
                                            word_at<Word>(from + 2 * sizeof(Word)))
                                     : first;
      row[x] = static_cast<Word>(grey);
      from += static_cast<std::size_t>(channels) * sizeof(Word);
    }
  }
}

int channels_of(const spng_ihdr& header) {
  switch (header.color_type) {
    case SPNG_COLOR_TYPE_GRAYSCALE_ALPHA:
      return 2;
    case SPNG_COLOR_TYPE_TRUECOLOR_ALPHA:
      return 4;
    default:
      return 3;  // palettes are unpacked to RGB
  }
}

Result<void> decode_channels(const EncodedImage& in, spng_ctx* context, const spng_ihdr& header,
                             std::vector<std::uint8_t>& scratch, Frame& out) {
  const int layout = header.color_type == SPNG_COLOR_TYPE_INDEXED ? SPNG_FMT_RGB8 : SPNG_FMT_PNG;
  std::size_t size_bytes = 0;
  int code = spng_decoded_image_size(context, layout, &size_bytes);
  if (code != 0) return png_error(in, code);
  scratch.resize(size_bytes);
  code = spng_decode_image(context, scratch.data(), scratch.size(), layout, 0);
  if (code != 0) return png_error(in, code);
  FrameFormat format{.width_px = static_cast<int>(header.width),
                     .height_px = static_cast<int>(header.height)};
  if (header.bit_depth == 16) {
    format.type = PixelType::mono16;
    format.bit_depth = in.options.bit_depth.value_or(16);
  }
  out.reset(format);
  const int channels = channels_of(header);
  if (header.bit_depth == 16) {
    to_luma<std::uint16_t>(scratch.data(), channels, format, out);
  } else {
    to_luma<std::uint8_t>(scratch.data(), channels, format, out);
  }
  return {};
}

/// A small file that claims a large image is refused before its memory is taken.
bool can_hold(const EncodedImage& in, const spng_ihdr& header) {
  const std::size_t row_bits = std::size_t{header.width} * header.bit_depth;
  return in.bytes.size() * kMaxDeflateRatio >= row_bits / 8 * header.height;
}

}  // namespace

Result<ImageNotes> decode_png(const EncodedImage& in, std::vector<std::uint8_t>& scratch,
                              Frame& out) {
  const auto opened = open_png(in);
  if (!opened) return opened.error();
  spng_ctx* context = opened.value().get();
  const auto header = read_header(in, context);
  if (!header) return header.error();
  if (!can_hold(in, header.value()))
    return bad_image(in.name, "is too short for the size that its PNG header declares");

  const int type = header.value().color_type;
  const auto decoded = type == SPNG_COLOR_TYPE_GRAYSCALE
                           ? decode_grey(in, context, header.value(), out)
                           : decode_channels(in, context, header.value(), scratch, out);
  if (!decoded) return decoded.error();
  // What follows the pixels is read only to see that the file is whole.
  if (const int code = spng_decode_chunks(context); code != 0) return png_error(in, code);

  spng_trns transparency{};
  return ImageNotes{
      .colour = type == SPNG_COLOR_TYPE_TRUECOLOR || type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ||
                type == SPNG_COLOR_TYPE_INDEXED,
      .alpha = type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA || type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ||
               present(spng_get_trns(context, &transparency))};
}

}  // namespace lsv
