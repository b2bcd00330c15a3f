// SPDX-License-Identifier: BSD-3-Clause
// Frames to files, in the forms that open_frames() reads back to the same counts.
//   png   8 bit, or 16 bit; 10, 12 and 14 bit counts go to the high bits, with an sBIT chunk, as
//         the PNG standard asks
//   pgm   binary (P5), maxval = full scale, 16-bit words big-endian
//   tiff  8 or 16 bit grey, deflate with horizontal differences, MaxSampleValue = full scale;
//         many pages in one file with TiffStackWriter
//   raw   pixels only, row after row, 16-bit words little-endian
// A file appears under its name only when it is complete; a file of that name is replaced.
// Errors: output_failed, naming the file. Allocates per frame; each object belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"

namespace lsv {

enum class FrameFileFormat { png, pgm, tiff, raw };

/// "png", "pgm", "tiff" or "raw".
std::optional<FrameFileFormat> frame_file_format_from(std::string_view word);
/// With the dot: ".png", ".pgm", ".tif", ".raw".
std::string_view extension(FrameFileFormat format);

/// The bytes of a PNG file.
Result<std::string> encode_png(const FrameView& frame);

Result<void> write_frame(const FrameView& frame, FrameFileFormat format, const std::string& path);

/// A multi-page TIFF, one page a frame. Destroyed without commit(), it leaves nothing behind.
class TiffStackWriter {
 public:
  /// `expected_bytes` of pixels in all pages: above 3.5e9 the file becomes a BigTIFF.
  static Result<TiffStackWriter> create(const std::string& path, std::int64_t expected_bytes);

  TiffStackWriter(TiffStackWriter&&) noexcept;
  TiffStackWriter& operator=(TiffStackWriter&&) = delete;
  ~TiffStackWriter();

  /// After an error every further call fails.
  Result<void> append(const FrameView& frame);

  /// Nothing may be appended afterwards.
  Result<void> commit();

 private:
  struct Stack;
  explicit TiffStackWriter(std::unique_ptr<Stack> stack);
  std::unique_ptr<Stack> stack_;
};

}  // namespace lsv
