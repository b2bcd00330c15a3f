// SPDX-License-Identifier: BSD-3-Clause
// One image file into one frame: PNG, TIFF (one page), PGM, BMP, JPEG, raw. The decoder follows
// from the extension and the first bytes must agree with it. Grey values are kept as stored; colour
// becomes luma (0.299 R + 0.587 G + 0.114 B, rounded). A size above the limit is refused before
// memory is taken, and a damaged or truncated file is an error, never part of a frame.
// One reader belongs to one thread; it reuses its buffers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/ingest/frame_source.h"

namespace lsv {

enum class ImageKind { png, tiff, pgm, bmp, jpeg, raw };

/// "PNG", "TIFF", ...
std::string_view word(ImageKind kind);
/// From the extension, upper or lower case; never raw, whose files say nothing of themselves.
std::optional<ImageKind> image_kind_of(const std::string& path);

struct DecodeOptions {
  std::int64_t max_pixels = 0;        // a declared width * height above this is refused
  std::optional<int> bit_depth = {};  // of 16-bit words; unset: as the file says, else 16
  std::optional<RawFormat> raw = {};  // of raw files, which hold one frame each
};

/// What else the decoder saw, so that the user can be told.
struct ImageNotes {
  bool colour = false;  // converted to luma
  bool alpha = false;   // ignored
  friend bool operator==(const ImageNotes&, const ImageNotes&) = default;
};

class ImageReader {
 public:
  explicit ImageReader(const DecodeOptions& options) : options_(options) {}

  /// Fills the pixels and the format of `out`; its stamp and index are left alone.
  Result<ImageNotes> read(const std::string& path, ImageKind kind, Frame& out);

 private:
  DecodeOptions options_;
  std::vector<std::uint8_t> encoded_;
  std::vector<std::uint8_t> scratch_;
};

}  // namespace lsv
