// SPDX-License-Identifier: BSD-3-Clause
// Where frames come from: one interface over image sequences, TIFF stacks, raw files, video,
// recordings and standard input. Frames arrive in order, one at a time, in the pixel depth they
// were stored in. A source belongs to one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"

namespace lsv {

struct SourceInfo {
  std::string description;   // e.g. "PNG sequence", "TIFF stack", "raw mono8 on standard input"
  FrameFormat format;        // after the ROI is applied
  FrameFormat whole_format;  // before
  std::optional<std::int64_t> frame_count;  // frames next() will deliver; unknown for pipe, video
  std::int64_t missing_count = 0;           // holes in the numbers of the whole input
  std::optional<Stamp> first_stamp;         // of the frames delivered; unknown without a time base
  std::optional<Stamp> last_stamp;          // unknown also when frame_count is
  std::vector<std::string> files;           // that are read; empty for standard input
  std::vector<std::string> warnings;        // a sentence each, e.g. "3 frames are missing ..."
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  virtual const SourceInfo& info() const = 0;

  /// Fills `out` with the next frame, or returns false at the end. Stamps and indices increase
  /// strictly. After an error the source is finished. Reuses the memory of `out`.
  virtual Result<bool> next(Frame& out) = 0;
};

/// Headerless pixels: `width x height` words, little-endian when 16 bit.
struct RawFormat {
  FrameFormat format;
  std::int64_t header_bytes = 0;  // skipped once at the start of each file or of the stream
};

/// Parses "WxH:mono8", "WxH:mono10", "WxH:mono12", "WxH:mono14", "WxH:mono16", each with an
/// optional ":header_bytes".
Result<RawFormat> parse_raw_format(const std::string& text);

/// Parses "x,y,w,h".
Result<Roi> parse_roi(const std::string& text);

struct SourceOptions {
  /// Exactly one of these two gives the time base; none is an error unless need_time is false or
  /// the input is a recording, which has its own.
  std::optional<double> rate_hz = {};  // frames per second of the numbered sequence, > 0
  std::string timestamps_path = {};    // file with one stamp per frame, see docs/formats.md
  bool need_time = true;               // false: stamps are the index in ns (inspection only)

  std::optional<RawFormat> raw = {};      // required for .raw .bin .y8 .y16 and "-"; forces raw
  std::optional<Roi> roi = {};            // cropped from every frame
  std::optional<int> bit_depth = {};      // significant bits of 16-bit words, when the file is mute
  std::int64_t start = 0;                 // first index delivered
  std::optional<std::int64_t> stop = {};  // first index not delivered
  std::int64_t step = 1;                  // every step-th index from start
  bool ignore_numbers = false;            // numbers in names do not mean missing frames
  bool salvage = false;                   // read what is sound of a damaged recording

  std::int64_t max_pixels = std::int64_t{64} << 20;  // a declared size above this is refused
};

/// `paths`: one directory, one glob pattern, one multi-page TIFF, one video, one recording, one raw
/// file, "-", or a list of image files. Opens and reads up to and including the first frame
/// delivered (on
/// "-" it waits for that frame); an error names the file. What is read how: docs/formats.md.
Result<std::unique_ptr<FrameSource>> open_frames(const std::vector<std::string>& paths,
                                                 const SourceOptions& options);

}  // namespace lsv
