// SPDX-License-Identifier: BSD-3-Clause
// One decoder per image format, all from bytes in memory, and the checks that they share.
// Internal to lsv/: use image_decode.h.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lsv/ingest/image_decode.h"

namespace lsv {

struct EncodedImage {
  const std::string& name;  // for errors
  std::span<const std::uint8_t> bytes;
  const DecodeOptions& options;
};

/// `scratch` is memory to be reused from call to call.
Result<ImageNotes> decode_png(const EncodedImage& in, std::vector<std::uint8_t>& scratch,
                              Frame& out);
Result<ImageNotes> decode_jpeg(const EncodedImage& in, Frame& out);
Result<ImageNotes> decode_bmp(const EncodedImage& in, Frame& out);
Result<ImageNotes> decode_pgm(const EncodedImage& in, Frame& out);

Error bad_image(const std::string& name, const std::string& what);
Error unsupported_image(const std::string& name, const std::string& what);

/// Zero, or above `max_pixels`, is an error.
Result<void> check_image_size(const std::string& name, std::int64_t width_px,
                              std::int64_t height_px, std::int64_t max_pixels);

/// The depth of FrameFormat (8, 10, 12, 14 or 16) that holds values up to `max_value`.
int bit_depth_for(int max_value);

/// Rounded luma of Rec. 601; exact for grey (r = g = b).
inline constexpr int luma(int r, int g, int b) {
  return (299 * r + 587 * g + 114 * b + 500) / 1000;
}

}  // namespace lsv
