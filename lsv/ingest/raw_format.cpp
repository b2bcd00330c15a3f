// SPDX-License-Identifier: BSD-3-Clause
// The texts of --raw and --roi.
#include "lsv/ingest/frame_source.h"
#include "lsv/ingest/option_text.h"

namespace lsv {
namespace {

/// "mono12" -> 12; empty for a word that lsv does not know.
std::optional<int> depth_of(std::string_view word) {
  constexpr std::string_view kPrefix = "mono";
  if (!word.starts_with(kPrefix)) return std::nullopt;
  word.remove_prefix(kPrefix.size());
  for (const int depth : {8, 10, 12, 14, 16}) {
    if (word == std::to_string(depth)) return depth;
  }
  return std::nullopt;
}

std::optional<FrameFormat> format_of(std::string_view size, std::string_view pixel_word) {
  const auto sides = split_at(size, 'x');
  if (sides.size() != 2) return std::nullopt;
  const auto width = whole_number<int>(sides[0]);
  const auto height = whole_number<int>(sides[1]);
  const auto depth = depth_of(pixel_word);
  if (!width || !height || !depth || *width < 1 || *height < 1) return std::nullopt;
  return FrameFormat{.width_px = *width,
                     .height_px = *height,
                     .type = *depth == 8 ? PixelType::mono8 : PixelType::mono16,
                     .bit_depth = *depth};
}

}  // namespace

Result<RawFormat> parse_raw_format(const std::string& text) {
  const Error refusal{ErrorCode::invalid_argument,
                      "\"" + text +
                          "\" is not WIDTHxHEIGHT:mono8, mono10, mono12, mono14 or mono16 with an "
                          "optional :HEADER_BYTES; example: --raw 640x480:mono8"};
  const auto parts = split_at(text, ':');
  if (parts.size() != 2 && parts.size() != 3) return refusal;
  const auto format = format_of(parts[0], parts[1]);
  if (!format) return refusal;
  RawFormat raw{.format = *format};
  if (parts.size() == 3) {
    const auto header_bytes = whole_number<std::int64_t>(parts[2]);
    if (!header_bytes || *header_bytes < 0) return refusal;
    raw.header_bytes = *header_bytes;
  }
  return raw;
}

Result<Roi> parse_roi(const std::string& text) {
  const Error refusal{
      ErrorCode::invalid_argument,
      "\"" + text + "\" is not X,Y,WIDTH,HEIGHT in px with X, Y >= 0; example: --roi 0,0,256,256"};
  const auto parts = split_at(text, ',');
  if (parts.size() != 4) return refusal;
  const auto x = whole_number<int>(parts[0]);
  const auto y = whole_number<int>(parts[1]);
  const auto width = whole_number<int>(parts[2]);
  const auto height = whole_number<int>(parts[3]);
  if (!x || !y || !width || !height || *x < 0 || *y < 0 || *width < 1 || *height < 1)
    return refusal;
  return Roi{.x_px = *x, .y_px = *y, .width_px = *width, .height_px = *height};
}

}  // namespace lsv
