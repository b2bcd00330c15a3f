// SPDX-License-Identifier: BSD-3-Clause
// Where simulated frames, and the truth about them, go until all of them are there: a TIFF stack,
// or a directory that gets its name at the end. Nothing is overwritten. Destroyed without commit(),
// it leaves nothing behind.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "lsv/core/frame.h"
#include "lsv/core/result.h"
#include "lsv/output/frame_writer.h"
#include "lsv/output/output_file.h"

namespace lsv::cli {

struct RecordingOptions {
  std::string output;  // a directory, or a .tif file for a stack
  std::string format;  // of the files in a directory: png (also when empty), tiff, pgm, raw
  std::optional<std::string> truth{};  // file of the truth; empty: truth.csv beside the frames
  std::int64_t pixel_bytes = 0;        // of all frames
};

class Recording {
 public:
  static Result<Recording> begin(const RecordingOptions& options);

  Recording(Recording&& other) noexcept;
  Recording& operator=(Recording&&) = delete;
  ~Recording();

  /// Only with RecordingOptions::truth.
  Result<void> add_truth(std::string_view text) { return truth_->write(text); }
  Result<void> add_frame(const Frame& frame);
  Result<void> commit();

 private:
  Recording() = default;
  Result<void> make_parent() const;
  Result<void> begin_directory();
  Result<void> open_truth(const std::string& asked);

  std::filesystem::path target_;
  std::filesystem::path part_directory_;  // empty for a stack, and once renamed
  std::optional<FrameFileFormat> format_;
  std::optional<TiffStackWriter> stack_;
  std::optional<OutputFile> truth_;
};

/// --frames as it may be, or invalid_argument.
Result<void> check_frame_count(std::int64_t frames);

/// Calls `record` for frames 0, 1, ... with a progress line on a terminal, then commits. The exit
/// code: an interrupt leaves nothing.
Result<int> record_frames(Recording recording, std::int64_t frames,
                          const std::function<Result<void>(std::int64_t, Recording&)>& record);

}  // namespace lsv::cli
